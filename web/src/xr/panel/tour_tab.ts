import type { Container } from "@pmndrs/uikit";

import type { Stop } from "../../model/tour";
import { texts } from "../../text/text";
import type { PanelContext } from "./panel_context";
import { button, column, each, kSmallFont, label, row, scrolled, when } from "./widgets";

/** The views that were saved, and the tour of them. */
export function tourTab(context: PanelContext): Container {
  const { host, live, viewer } = context;
  const { tour } = host;
  const t = texts().views;
  const has = (text: () => string | undefined) => live(() => Boolean(text()));
  const said = (text: () => string | undefined, properties: Parameters<typeof label>[1] = {}) =>
    when(
      has(text),
      label(
        live(() => text() ?? ""),
        properties,
      ),
    );
  return column(
    { gap: 10 },
    said(() => (viewer.state.stops.length === 0 ? texts().headset.noViews : "")),
    when(
      live(() => viewer.state.stops.length > 0),
      row(
        button(texts().headset.previousView, () => void tour.step(-1), {
          enabled: live(() => tour.index > 0),
        }),
        button(
          live(() => (tour.playing ? t.pause : t.play)),
          () => void tour.toggle(),
          { pressed: live(() => tour.playing) },
        ),
        button(texts().headset.nextView, () => void tour.step(1), {
          enabled: live(() => tour.index + 1 < tour.stops.length),
        }),
      ),
    ),
    said(() => tour.stop.value?.text, { size: kSmallFont }),
    said(() => tour.trouble, { size: kSmallFont, color: "#ffb3a6" }),
    scrolled(
      each(
        column({ gap: 6 }),
        live(() => viewer.state.stops),
        (stops) => listed(context, stops),
      ),
    ),
  );
}

function listed({ host, live, spell }: PanelContext, stops: readonly Stop[]): Container[] {
  spell(stops.map(({ name, text }) => name + text));
  return stops.map(({ id, name }, i) =>
    button(`${i + 1}  ${name || texts().views.unnamed}`, () => void host.tour.show(id), {
      pressed: live(() => host.tour.stop.value?.id === id),
    }),
  );
}
