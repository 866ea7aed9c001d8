// Questions that come faster than their answers.

interface Asked<Question> {
  question: Question;
  sequence: number;
  controller: AbortController;
}

export interface LatestOptions<Question, Answer> {
  ask: (question: Question, sequence: number, signal: AbortSignal) => Promise<Answer>;
  /** Whether a newer question need not wait for the answer to this one. */
  interruptible: (question: Question) => boolean;
  answered: (answer: Answer, question: Question) => void;
  failed: (error: unknown, question: Question) => void;
  /** After an answer, until what it changed is drawn: the question that is then sent is newer than one sent before. */
  drawn: () => Promise<void>;
}

/** At most one question is under way and one waits, the newest. Sequence numbers rise; what comes of a question that was given up is dropped. */
export class Latest<Question, Answer> {
  private under_way: Asked<Question> | null = null;
  private waiting: Question | null = null;
  private sequence = 0;

  constructor(private readonly options: LatestOptions<Question, Answer>) {}

  put(question: Question): void {
    if (this.under_way && this.options.interruptible(this.under_way.question)) this.giveUp();
    if (this.under_way) this.waiting = question;
    else void this.send(question);
  }

  /** Gives up what is under way and what waits. */
  stop(): void {
    this.waiting = null;
    this.giveUp();
  }

  private giveUp(): void {
    this.under_way?.controller.abort();
    this.under_way = null;
  }

  private async send(question: Question): Promise<void> {
    const asked = { question, sequence: ++this.sequence, controller: new AbortController() };
    this.under_way = asked;
    const { ask, answered, failed, drawn } = this.options;
    let answer: Answer;
    try {
      answer = await ask(question, asked.sequence, asked.controller.signal);
    } catch (error) {
      if (this.under_way === asked) failed(error, question);
      return this.next(asked);
    }
    if (this.under_way === asked) answered(answer, question);
    await drawn();
    this.next(asked);
  }

  /** Sends what waits, unless the question was given up: then another is under way already. */
  private next(asked: Asked<Question>): void {
    if (this.under_way !== asked) return;
    this.under_way = null;
    const { waiting } = this;
    this.waiting = null;
    if (waiting !== null) void this.send(waiting);
  }
}
