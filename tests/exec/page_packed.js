// node page_packed.js MOTION.js FILE: whether standard input, of `xz --format=lzma` with the properties of src/commands/pack.h, unpacks to FILE.
const fs = require("fs"), [script, file] = process.argv.slice(2), {unpacked} = require(require("path").resolve(script));
const lzma = fs.readFileSync(0), want = fs.readFileSync(file), size = Buffer.alloc(4);
size.writeUInt32LE(want.length);
const got = Buffer.from(unpacked(new Uint8Array(Buffer.concat([size, lzma.subarray(13)]))));
process.exit(lzma[0] == 90 && got.equals(want) ? 0 : 1); // 90: (pb*5 + lp)*9 + lc
