import { Viewer } from "./viewer";
const canvas = document.createElement("canvas");
canvas.style.cssText = "position:fixed;inset:0;width:100%;height:100%";
document.body.append(canvas);
const viewer = new Viewer(canvas);
void viewer.open("x", "cases/x.sog");
