import type { Container, Text } from "@pmndrs/uikit";

import type { GreyOpenings } from "../../model/face_style";
import type { FaceSource } from "../../model/faces";
import { isSameWindow, type Window } from "../../model/grey";
import { kRigs } from "../../model/rigs";
import { capital } from "../../model/values";
import { texts } from "../../text/text";
import { isByVolume, type PanelContext } from "./panel_context";
import { button, choice, column, each, kSmallFont, label, row, slider, when } from "./widgets";

/** Among rigs, the lights that the case was made in. */
const kOwnLight = "";
const kChoices = [kOwnLight, ...kRigs.keys()];
/** As many as stand in a row: names of rigs are short. */
const kRigRows = [kChoices.slice(0, 3), kChoices.slice(3)];

type LampHand = "none" | "left" | "right";

/** Cut faces: what they are drawn from, in which light, and how grey. */
export function faceTab(context: PanelContext): Container {
  const { viewer, live } = context;
  const byVolume = live(() => isByVolume(viewer));
  return column(
    { gap: 10 },
    choice<FaceSource>(
      texts().headset.sources,
      live(() => (isByVolume(viewer) ? "volume" : "splats")),
      (source) => viewer.store.setSection(source),
      live(() => !viewer.noSection),
    ),
    when(
      live(() => viewer.noSection !== null),
      label(
        live(() => viewer.noSection ?? ""),
        { quiet: true, size: kSmallFont },
      ),
    ),
    when(
      live(() => canChangeRig(context)),
      column({ gap: 10 }, ...light(context)),
    ),
    when(
      byVolume,
      column(
        { gap: 10 },
        label(texts().headset.blend),
        slider(
          live(() => ({ min: 0, max: 1, value: viewer.state.grey })),
          (grey) => viewer.store.setGrey(grey),
        ),
      ),
    ),
    when(
      live(() => isGrey(context) && canChangeRig(context)),
      choice<GreyOpenings>(
        texts().headset.openings,
        live(() => viewer.state.openings),
        (openings) => viewer.store.setOpenings(openings),
      ),
    ),
    when(
      live(() => isGrey(context)),
      greyWindow(context),
    ),
  );
}

function canChangeRig({ viewer }: PanelContext): boolean {
  return isByVolume(viewer) && viewer.canChangeRig === true;
}

function isGrey({ viewer }: PanelContext): boolean {
  return isByVolume(viewer) && viewer.state.grey > 0 && viewer.window !== null;
}

function light(context: PanelContext): (Container | Text)[] {
  const { viewer, host, live, set } = context;
  const t = texts().headset;
  const turns = live(() => !viewer.state.lamp);
  return [
    label(t.light),
    ...kRigRows.map((names) =>
      choice<string>(
        Object.fromEntries(
          names.map((name) => [name, name ? (texts().light.rigs[name] ?? capital(name)) : t.asMade]),
        ),
        live(() => viewer.state.rig ?? kOwnLight),
        (name) => viewer.store.setRig(name === kOwnLight ? null : name),
      ),
    ),
    choice<LampHand>(
      t.lamp,
      live(() => (viewer.state.lamp ? host.lamp.hand : "none")),
      (hand) => set(() => holdLamp(context, hand)),
    ),
    when(
      live(() => host.lamp.hand !== null),
      button(t.leaveLamp, () => set(() => (host.lamp.hand = null))),
    ),
    when(turns, label(live(() => t.turned(Math.round(viewer.state.turn))))),
    when(
      turns,
      slider(
        live(() => ({ min: -180, max: 180, value: viewer.state.turn })),
        (turn) => viewer.store.setTurn(Math.round(turn)),
      ),
    ),
  ];
}

/** In a hand; one that is put out is held no more. */
function holdLamp({ viewer, host }: PanelContext, hand: LampHand): void {
  host.lamp.hand = hand === "none" ? null : hand;
  if (hand === "none") {
    viewer.store.setLamp(null);
  }
}

/** Which values are black and which white. */
function greyWindow({ viewer, host, live, set }: PanelContext): Container {
  const { windowGrip } = host.stage;
  const t = texts().headset;
  const change = (part: Partial<Window>) => {
    const { window } = viewer;
    viewer.store.setWindow(window && { ...window, ...part });
  };
  const range = (part: keyof Window) =>
    live(() => {
      const curve = viewer.section?.curve ?? [0, 1];
      const [low, high] = [curve[0]!, curve.at(-1)!];
      const value = viewer.window?.[part] ?? 0;
      return part === "center" ? { min: low, max: high, value } : { min: 1, max: high - low, value };
    });
  const presets = each(
    row(),
    live(() => viewer.windows),
    (windows) =>
      [...windows].map(([name, one]) =>
        button(name, () => viewer.store.setWindow(one), {
          pressed: live(() => isSameWindow(one, viewer.window)),
        }),
      ),
  );
  return column(
    { gap: 10 },
    presets,
    label(live(() => t.center(Math.round(viewer.window?.center ?? 0)))),
    slider(range("center"), (center) => change({ center })),
    label(live(() => t.width(Math.round(viewer.window?.width ?? 0)))),
    slider(range("width"), (width) => change({ width })),
    button(t.windowByHand, () => set(() => (windowGrip.wanted = !windowGrip.wanted)), {
      pressed: live(() => windowGrip.wanted),
    }),
    when(
      live(() => windowGrip.wanted),
      label(t.windowHint, { quiet: true, size: kSmallFont }),
    ),
  );
}
