// The errors and warnings that Khronos' validator finds in GLB files, as JSON; see test_gltf_read.py.
import { readFileSync } from "node:fs";
import validator from "gltf-validator";

const found = [];
for (const path of process.argv.slice(2)) {
  const report = await validator.validateBytes(new Uint8Array(readFileSync(path)), { format: "glb" });
  const wrong = report.issues.messages.filter((message) => message.severity < 2);
  found.push(wrong.map(({ code, message, pointer }) => `${pointer}: ${code}: ${message}`));
}
console.log(JSON.stringify(found));
