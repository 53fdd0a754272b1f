import type { Container } from "@pmndrs/uikit";

import { texts } from "../../text/text";
import { column, kSmallFont, label } from "./widgets";

/** What hands do in the room. */
export function helpTab(): Container {
  return column(
    { gap: 7 },
    ...texts().headset.help.map(([what, does]) =>
      column({ gap: 1 }, label(what, { size: kSmallFont }), label(does, { quiet: true, size: kSmallFont })),
    ),
  );
}
