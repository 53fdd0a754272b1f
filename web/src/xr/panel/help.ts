/** What hands do in the room. */
export const kHelp: [string, string][] = [
  [
    "Trigger, or a pinch",
    "presses what is pointed at; takes hold of the plane (from afar at its rim) or the case",
  ],
  ["Grip button", "takes hold of the case alone"],
  ["Both hands on the case", "turn it, and make it larger or smaller"],
  ["Stick forward or back", "slides the plane"],
  ["Button A or X, or the button on a bare wrist", "puts this panel before you; the bar at its top moves it"],
  [
    "A kind of mark, then trigger or pinch at a face",
    "marks the point; the panel lists marks and removes them",
  ],
  ["The cube above", "shows how the patient lies; a side that is pressed is turned to you"],
];
