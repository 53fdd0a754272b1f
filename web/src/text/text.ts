import { english, type Texts } from "./en";

let chosen: Texts = english;

/** What the viewer says, in the language that was chosen before its first part was made. */
export function texts(): Texts {
  return chosen;
}
