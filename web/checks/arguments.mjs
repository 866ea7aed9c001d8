// What a check is called with, and how it ends.

/** The word after `--name`; without `--name` the fallback. */
export function argument(name, fallback) {
  const at = process.argv.indexOf(name);
  if (at < 0) return fallback;
  const value = process.argv[at + 1];
  if (value === undefined || value.startsWith('--')) throw new Error(`${name} needs a value`);
  return value;
}

/** A number above zero. */
export function numberArgument(name, fallback) {
  const value = Number(argument(name, fallback));
  if (!(value > 0 && Number.isFinite(value))) throw new Error(`${name} needs a number above 0`);
  return value;
}

export function chromiumPath() {
  return argument('--chromium', process.env['CHROMIUM'] ?? '/usr/bin/chromium');
}

/** `main` gives the exit status; an error is said and is 1. */
export async function run(main) {
  process.exitCode = await main().catch((error) => {
    console.error([error.message, error.cause?.message].filter(Boolean).join(': '));
    return 1;
  });
}
