// Runs Khronos' glTF validator over files: `node tools/validate_gltf.mjs FILE...` (after `npm ci` in tools/).
// Prints every error and a count of the rest; exits 1 when any file has an error.
import { readFile } from 'node:fs/promises';
import { dirname, resolve } from 'node:path';
import { validateBytes } from 'gltf-validator';

const files = process.argv.slice(2);
if (files.length === 0) {
  console.error('usage: node validate_gltf.mjs FILE...');
  process.exit(2);
}

const ERROR = 0;
let failed = false;
for (const file of files) {
  const folder = dirname(resolve(file));
  const report = await validateBytes(new Uint8Array(await readFile(file)), {
    uri: file,
    maxIssues: 0,
    externalResourceFunction: async (uri) =>
      new Uint8Array(await readFile(resolve(folder, decodeURIComponent(uri)))),
  });
  const { numErrors, numWarnings, numInfos } = report.issues;
  console.log(`${file}: ${numErrors} errors, ${numWarnings} warnings, ${numInfos} notes`);
  const errors = report.issues.messages.filter((message) => message.severity === ERROR);
  for (const { code, message, pointer } of errors.slice(0, 20)) console.log(`  ${pointer}: ${code}: ${message}`);
  failed ||= numErrors > 0;
}
process.exit(failed ? 1 : 0);
