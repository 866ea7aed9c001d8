// What several documents have.
import type { LobesDocument } from '#schema/lobes';

export type Num = number | null;
/** The structure that a mode belongs to. */
export type Owner = NonNullable<LobesDocument['points'][number]['mode_of']>;

export interface Fact {
  label: string;
  value: string;
  meaning?: string;
}
