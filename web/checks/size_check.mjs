// node size_check.mjs FILE… : exits 1 where the page's files, compressed, are together longer than they may be.
import { readFileSync } from 'node:fs';
import { basename } from 'node:path';
import { gzipSync } from 'node:zlib';

const most_bytes = 1.6e6;
let total = 0;
for (const file of process.argv.slice(2)) {
  const bytes = gzipSync(readFileSync(file)).length;
  total += bytes;
  console.log(`${basename(file)}: ${(bytes / 1e3).toFixed(0)} kB compressed`);
}
console.log(`${(total / 1e6).toFixed(2)} MB of ${most_bytes / 1e6} MB`);
process.exitCode = total > 0 && total <= most_bytes ? 0 : 1;
