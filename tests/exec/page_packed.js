// node page_packed.js from MOTION.js PAGE.html: the page's module as a file of `xz --format=lzma`.
// node page_packed.js to MOTION.js FILE: whether standard input, such a file with the properties of src/base/lzma.h, unpacks to FILE.
const fs = require("fs"), [way, script, file] = process.argv.slice(2), {bytes_of, unpacked} = require(require("path").resolve(script));
if (way == "from") {
  const packed = Buffer.from(bytes_of(/const packed = "([^"]*)/.exec(fs.readFileSync(file, "utf8"))[1]));
  // properties (pb*5 + lp)*9 + lc, a window of 16 MiB, the size in 8 bytes
  process.stdout.write(Buffer.concat([Buffer.from([90, 0, 0, 0, 1]), packed.subarray(0, 4), Buffer.alloc(4), packed.subarray(4)]));
} else {
  const lzma = fs.readFileSync(0), want = fs.readFileSync(file), size = Buffer.alloc(4);
  size.writeUInt32LE(want.length);
  const got = Buffer.from(unpacked(new Uint8Array(Buffer.concat([size, lzma.subarray(13)]))));
  process.exit(lzma[0] == 90 && got.equals(want) ? 0 : 1);
}
