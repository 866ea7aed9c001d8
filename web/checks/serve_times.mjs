// How soon the page redraws while something is dragged.

function share(sorted, part) {
  return sorted[Math.min(sorted.length - 1, Math.ceil(part * sorted.length) - 1)];
}

/** From here on redraws are counted. */
export async function watchRedraws(page) {
  await page.evaluate(`window.robomillLatency = []`);
}

/** "80 redraws in a drag, …" since they are counted; null, and a problem, where there were hardly any. */
export async function redrawsText(page, what, problems) {
  const times = (await page.evaluate(`window.robomillLatency ?? []`)).sort((a, b) => a - b);
  if (times.length < 3) {
    problems.push(`${what}: ${times.length} redraws while it was dragged`);
    return null;
  }
  const below = times.filter((time) => time < 100).length / times.length;
  return `${times.length} redraws in a drag, ${(100 * below).toFixed(0)} % under 100 ms (median ${share(times, 0.5).toFixed(0)}, 95 % ${share(times, 0.95).toFixed(0)}, most ${times.at(-1).toFixed(0)} ms)`;
}
