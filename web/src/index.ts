import { ClipgsViewerElement } from "./element";

export { ClipgsViewerElement };
export type * from "./api";

declare global {
  interface HTMLElementTagNameMap {
    "clipgs-viewer": ClipgsViewerElement;
  }
}

if (!customElements.get("clipgs-viewer")) {
  customElements.define("clipgs-viewer", ClipgsViewerElement);
}
