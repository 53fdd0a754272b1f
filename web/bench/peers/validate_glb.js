// Holds glTF files to the Khronos validator: node validate_glb.js FILE... It does not know KHR_gaussian_splatting, whose
// attributes are no others' names to it; anything else that it finds fails.
import { readFileSync } from "node:fs";
import validator from "gltf-validator";

for (const file of process.argv.slice(2)) {
  const { issues } = await validator.validateBytes(new Uint8Array(readFileSync(file)));
  const own = ({ code, pointer }) =>
    code === "MESH_PRIMITIVE_INVALID_ATTRIBUTE" && pointer.includes("/KHR_gaussian_splatting:");
  const wrong = issues.messages.filter((message) => message.severity < 2 && !own(message));
  console.log(`${file}: ${wrong.length === 0 ? "valid" : JSON.stringify(wrong)}`);
  process.exitCode ||= wrong.length > 0 ? 1 : 0;
}
