/** Where the page shows something, CSS px. */
export interface Spot {
  x: number;
  y: number;
}

/** What runs functions in a page: a tab of any browser, and a page of Playwright. */
export interface Evaluates {
  evaluate<R>(what: () => R | Promise<R>): Promise<R>;
  evaluate<R, A>(what: (given: A) => R | Promise<R>, given: A): Promise<R>;
}

/** A tab of a browser that WebDriver drives. */
export interface Tab extends Evaluates {
  open(url: string): Promise<void>;
  /** Moves the mouse there. */
  move(to: Spot): Promise<void>;
  click(at: Spot): Promise<void>;
  press(key: string): Promise<void>;
  /** What the page shows, as a PNG. */
  screenshot(): Promise<Buffer>;
}

/** A running browser with one tab. */
export interface Browser {
  readonly tab: Tab;
  /** As it calls itself. */
  readonly version: string;
  close(): Promise<void>;
}

/** A function with what it is given, as an expression for the page whose value is a promise of JSON. */
export function inPage(what: (given: never) => unknown, given: unknown): string {
  return `(async () => JSON.stringify((await (${String(what)})(${JSON.stringify(given) ?? ""})) ?? null))()`;
}

/** Until `happens` in the page. */
export async function waitFor<A>(
  page: Evaluates,
  happens: (given: A) => unknown,
  given: A,
  milliseconds = 120_000,
): Promise<void> {
  const end = Date.now() + milliseconds;
  while (!(await page.evaluate(happens, given))) {
    if (Date.now() > end) {
      throw new Error(`the page did not come to ${String(happens)}`);
    }
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
}

type Action = Record<string, unknown>;

/** Actions of a mouse and of keys, in the words that both kinds of WebDriver share. */
export const kActions = {
  move: ({ x, y }: Spot): Action[] => [
    mouse({ type: "pointerMove", x: Math.round(x), y: Math.round(y), duration: 0 }),
  ],
  click: ({ x, y }: Spot): Action[] => [
    mouse(
      { type: "pointerMove", x: Math.round(x), y: Math.round(y), duration: 0 },
      { type: "pointerDown", button: 0 },
      { type: "pointerUp", button: 0 },
    ),
  ],
  press: (key: string): Action[] => [
    {
      type: "key",
      id: "keys",
      actions: [
        { type: "keyDown", value: key },
        { type: "keyUp", value: key },
      ],
    },
  ],
};

function mouse(...actions: Action[]): Action {
  return { type: "pointer", id: "mouse", parameters: { pointerType: "mouse" }, actions };
}
