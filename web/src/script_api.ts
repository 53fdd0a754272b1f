import { Vector3 } from "three";

import type { ApiCut, ClipgsApi } from "./api";
import type { App } from "./app";
import { type Cut, makeCut } from "./model/cut";
import type { Plane, Triple } from "./model/geometry";
import { isShape, makeMark, type Mark, markText, measure } from "./model/marks";
import { viewFrom } from "./model/view";
import type { Viewer } from "./viewer";

function unitCut({ normal, offset, thickness }: ApiCut): Cut {
  return makeCut(new Vector3(...normal), offset, thickness ?? null);
}

function apiPlane({ normal, offset }: Plane): { normal: Triple; offset: number } {
  return { normal: normal.toArray(), offset };
}

function apiMark(mark: Mark, viewer: Viewer): ClipgsApi["marks"][number] {
  const { points, normal, ...rest } = mark;
  const measured = measure(mark, viewer.section);
  const { value, values, mm, degrees, area } = measured;
  return {
    ...rest,
    points: points.map((point) => point.toArray()),
    normal: normal?.toArray() ?? null,
    text: markText({ ...mark, name: "" }, measured),
    value: value?.value ?? null,
    error: value?.error ?? null,
    mm,
    degrees,
    area,
    mean: values?.mean ?? null,
    deviation: values?.deviation ?? null,
  };
}

/** What scripts do with an app; `ready` as in ClipgsApi. */
export function makeApi(app: App, ready: () => Promise<void>): ClipgsApi {
  const { viewer, headset } = app;
  const { player } = app.views;
  return {
    get ready() {
      return ready();
    },
    stats: viewer.stats,
    get steady() {
      return viewer.steady;
    },
    set steady(steady) {
      viewer.steady = steady;
    },
    open: (name) => app.host.open(name),
    openFile: (file) => app.host.openFile(file),
    setView: ({ azimuth, elevation, zoom = 1 }) => viewer.store.setView(viewFrom(azimuth, elevation, zoom)),
    setPlane: (plane) => {
      viewer.store.setCuts(plane ? [unitCut(plane)] : []);
    },
    setCuts: (cuts, active) => viewer.store.setCuts(cuts.map(unitCut), active),
    setMode: (mode) => viewer.store.setMode(mode),
    setState: (state) => viewer.store.setPlaneState(state),
    get states() {
      const { states } = viewer.store;
      return states && { ...states, axis: states.axis.toArray() };
    },
    setClip: (clip) => viewer.store.setClip(clip),
    setSection: (section) => viewer.store.setSection(section),
    setGrey: (grey) => viewer.store.setGrey(Math.min(1, Math.max(0, grey))),
    setOpenings: (openings) => viewer.store.setOpenings(openings),
    setRig: (rig) => viewer.store.setRig(rig),
    setTurn: (degrees) => viewer.store.setTurn(degrees),
    setLamp: (from) => viewer.store.setLamp(from),
    setBackground: (background) => viewer.store.setBackdrop(background),
    setDepthCue: (strength) => viewer.store.setDepthCue(strength),
    setWindow: (window) => viewer.store.setWindow(window && { ...window }),
    setLayers: (layers) => viewer.store.setLayers(layers),
    addMark: ({ kind, points, normal, name, note }) => {
      const shape = {
        kind,
        points: points.map((point) => new Vector3(...point)),
        normal: normal ? new Vector3(...normal).normalize() : null,
      };
      const mark = isShape(shape) ? makeMark(shape, name, note) : null;
      return mark && viewer.hasValues(shape) && viewer.store.addMark(mark) ? mark.id : null;
    },
    removeMark: (id) => viewer.store.removeMark(id),
    describeMark: (id, words) => viewer.store.setWords(id, words),
    get marks() {
      return viewer.state.marks.map((mark) => apiMark(mark, viewer));
    },
    get views() {
      return viewer.state.stops.map(({ name, text, show, fly, stay }) => ({
        name,
        text,
        link: show,
        fly,
        stay,
      }));
    },
    saveView: (name, text) => app.views.save(name, text) !== null,
    showView: async (index) => {
      const stop = viewer.state.stops[index];
      await (stop && player.show(stop.id));
    },
    playTour: () => player.play(),
    stopTour: () => player.leave(),
    get tour() {
      const { index, playing, trouble } = player;
      return { index: index < 0 ? null : index, playing, trouble };
    },
    get bounds() {
      const bounds = viewer.info?.bounds;
      return bounds ? { min: bounds.min.toArray(), max: bounds.max.toArray() } : null;
    },
    get state() {
      const { view, mode, cuts, clip, section, grey, openings, rig, turn, lamp, layers } = viewer.state;
      const { backdrop, depthCue } = viewer.state;
      return {
        case: viewer.caseName,
        view: { azimuth: view.azimuth, elevation: view.elevation, zoom: view.zoom },
        plane: viewer.cut && apiPlane(viewer.cut),
        cuts: cuts.map((cut) => ({
          ...apiPlane(cut),
          ...(cut.thickness === null ? {} : { thickness: cut.thickness }),
        })),
        mode,
        state: viewer.store.planeState,
        clip,
        section,
        grey,
        openings,
        rig,
        turn,
        lamp,
        background: backdrop,
        depthCue,
        window: viewer.window,
        layers: { ...layers },
      };
    },
    renderToPixels: (width, height, moving) => viewer.captures.pixels(width, height, moving),
    picture: (wanted) => app.pictures.take({ transparent: false, labels: true, ...wanted }),
    headset: {
      get worn() {
        return headset.worn;
      },
      enter: (surroundings = "immersive-vr") => headset.enter(surroundings),
      leave: () => headset.leave(),
      get scale() {
        return headset.stage.scale;
      },
      capture: () => headset.capture(),
      get steady() {
        return headset.governor.enabled;
      },
      set steady(steady) {
        headset.governor.enabled = steady;
      },
      get effort() {
        return headset.governor.effort;
      },
      get message() {
        return app.message.trouble.value?.text ?? "";
      },
      find: (text) => headset.panel?.find(text)?.toArray() ?? null,
    },
    project: (point) => {
      const at = viewer.camera.project(new Vector3(...point));
      const box = viewer.canvas.getBoundingClientRect();
      return at && { x: at.x + box.left, y: at.y + box.top };
    },
  };
}
