// What page and server say to each other about the program of a job.
import type { BlocksDocument, Num } from '../../documents';

export interface ProgramRequest {
  job: number;
  gamma: [path_mm: number, gamma_deg: number][]; // from γ as programmed; straight between, constant beyond
  client: string;
  channel: 'program';
  sequence: number;
}

/** A block that the robot cannot cut so: it cannot stand there, or something comes too near. */
export interface LostBlock {
  block: number; // from 1
  line: Num;
  text: string;
}

/** The γ that was evaluated, at the places of the path that were looked at. */
export interface EvaluatedGamma {
  block: number[];
  path_mm: number[];
  gamma_deg: Num[];
  margin: Num[];
}

export interface ProgramAnswer {
  sequence: number;
  blocks: BlocksDocument;
  lost: LostBlock[];
  gamma: EvaluatedGamma;
  unstable: number;
  least_margin: Num;
  worst_block: Num; // nearest to chatter
  notes: string[];
  milliseconds: number;
}
