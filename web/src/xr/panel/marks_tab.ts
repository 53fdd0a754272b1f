import type { Container } from "@pmndrs/uikit";
import { computed } from "@preact/signals-core";

import { type Mark, type MarkKind, markText, measure } from "../../model/marks";
import { texts } from "../../text/text";
import type { PanelContext } from "./panel_context";
import { button, column, each, label, row, scrolled, when } from "./widgets";

/** What can be marked, and what is. */
export function marksTab(context: PanelContext): Container {
  const { viewer, marking, live, set } = context;
  const tool = (kind: MarkKind) =>
    button(texts().marks.kinds[kind], () => set(() => marking.toggle(kind)), {
      pressed: computed(() => marking.kind === kind),
    });
  return column(
    { gap: 10 },
    when(
      live(() => viewer.section !== null),
      column(
        { gap: 10 },
        row(tool("point"), tool("length"), tool("angle")),
        row(
          tool("region"),
          tool("outline"),
          button(texts().headset.endOutline, () => set(() => marking.finish()), {
            enabled: computed(() => marking.kind === "outline" && marking.points.length > 2),
          }),
        ),
      ),
    ),
    scrolled(
      each(
        column({ gap: 6 }),
        live(() => viewer.state.marks),
        (marks) => listed(context, marks),
      ),
    ),
  );
}

function listed({ viewer, spell }: PanelContext, marks: readonly Mark[]): Container[] {
  const said = marks.map((mark) => markText(mark, measure(mark, viewer.section)));
  spell(said);
  return marks.map((mark, i) => {
    const remove = button(texts().headset.remove, () => viewer.store.removeMark(mark.id));
    remove.setProperties({ flexGrow: 0, flexBasis: 90 });
    return row(column({ flexGrow: 1, flexShrink: 1, justifyContent: "center" }, label(said[i]!)), remove);
  });
}
