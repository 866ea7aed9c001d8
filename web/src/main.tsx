import { render } from 'preact';
import type { Report } from './documents';
import { Page } from './page';
import { drawAll, drawOnEvents } from './plot';

/** The one place that knows where documents come from: here, from the page itself. */
function fetchDocument(): Promise<Report> {
  return Promise.resolve(JSON.parse(document.getElementById('report-data')?.textContent ?? 'null') as Report);
}

async function start(): Promise<void> {
  const report = await fetchDocument();
  render(<Page report={report} />, document.getElementById('page')!);
  if (window.location.hash.length > 1) document.getElementById(window.location.hash.slice(1))?.scrollIntoView();
  drawOnEvents();
  await drawAll();
  document.documentElement.dataset['plots'] = 'ready';
}

start().catch((error: unknown) => {
  document.getElementById('page')!.textContent = 'This page could not be shown.';
  console.error(error);
});
