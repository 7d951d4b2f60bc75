// What mmd-parser makes of a VMD; called by tests/test_vmd.py as: node vmd.mjs FILE [right]
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

const mmd = createRequire(import.meta.url)("mmd-parser");
const Parser = mmd.Parser ?? mmd.MMDParser?.Parser ?? globalThis.MMDParser.Parser;
const file = readFileSync(process.argv[2]);
const bytes = file.buffer.slice(file.byteOffset, file.byteOffset + file.length);
console.log(JSON.stringify(new Parser().parseVmd(bytes, process.argv[3] === "right")));
