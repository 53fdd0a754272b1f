// PlayCanvas: a plane by its hooks for splats as they are drawn, which see their centres.
import * as pc from "playcanvas";

const kModify = `
uniform vec4 uPlane;
void modifySplatCenter(inout vec3 center) {}
void modifySplatRotationScale(vec3 originalCenter, vec3 modifiedCenter, inout vec4 rotation, inout vec3 scale) {
  if (dot(uPlane.xyz, modifiedCenter) < uPlane.w) {
    scale = vec3(0.0);
  }
}
void modifySplatColor(vec3 center, inout vec4 color) {}
`;

export async function start(url, size, fov) {
  const canvas = document.createElement("canvas");
  document.body.append(canvas);
  const graphicsDevice = await pc.createGraphicsDevice(canvas, {
    deviceTypes: [pc.DEVICETYPE_WEBGL2],
    antialias: false,
  });
  graphicsDevice.maxPixelRatio = 1;
  const app = new pc.AppBase(canvas);
  const options = new pc.AppOptions();
  options.graphicsDevice = graphicsDevice;
  options.componentSystems = [pc.CameraComponentSystem, pc.GSplatComponentSystem];
  options.resourceHandlers = [pc.GSplatHandler, pc.TextureHandler];
  app.init(options);
  app.setCanvasFillMode(pc.FILLMODE_NONE, size, size);
  app.setCanvasResolution(pc.RESOLUTION_FIXED, size, size);
  app.autoRender = false; // else it draws while others are measured
  app.start();
  const asset = new pc.Asset("case", "gsplat", { url });
  app.assets.add(asset);
  await new Promise((done, fail) => {
    asset.ready(done);
    asset.once("error", fail);
    app.assets.load(asset);
  });
  const camera = new pc.Entity();
  camera.addComponent("camera", { fov, clearColor: new pc.Color(0, 0, 0), nearClip: 0.01, farClip: 100 });
  const splats = new pc.Entity();
  splats.addComponent("gsplat", { asset });
  app.root.addChild(camera);
  app.root.addChild(splats);
  const { material } = app.scene.gsplat;
  material.getShaderChunks(pc.SHADERLANGUAGE_GLSL).set("gsplatModifyVS", kModify);
  const setPlane = (cut) => {
    material.setParameter("uPlane", cut ? [...cut.normal, cut.offset] : [0, 0, 0, -1]);
    material.update();
  };
  setPlane(null);
  return {
    setCamera(matrix) {
      const pose = new pc.Mat4().set(matrix);
      camera.setPosition(pose.getTranslation());
      camera.setRotation(new pc.Quat().setFromMat4(pose));
    },
    setPlane,
    /** In the next animation frame. */
    draw() {
      app.renderNextFrame = true;
    },
  };
}
