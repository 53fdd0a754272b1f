import { Preference } from "../ui/preference";

/** The hand that people do most with: the panel stands at the other. */
export const handedness = new Preference("clipgs.handed", ["right", "left"]);

/** Who sits reaches less far, and walks around nothing. */
export const posture = new Preference("clipgs.posture", ["standing", "seated"]);

/** Whether what to do first was said already. */
export const hints = new Preference("clipgs.headset-hint", ["new", "seen"]);
