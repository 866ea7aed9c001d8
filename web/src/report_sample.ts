// The data of the sample report, which the C++ side writes (web.page_sample), for tests.
import { readFileSync } from 'node:fs';
import type { Report } from './documents';
import { requireReport } from './parse';

const text = /<script type="application\/json" id="report-data">(.*?)<\/script>/s.exec(readFileSync('sample.html', 'utf8'))![1]!;

export function sampleReport(): Report {
  const report: unknown = JSON.parse(text);
  requireReport(report);
  return report;
}
