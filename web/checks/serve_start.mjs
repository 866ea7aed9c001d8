// Starts the application's server.
import { spawn } from 'node:child_process';

const start_ms = 30000;

/** Starts `PROGRAM serve FOLDER`: its process number, the address that it says, and how it is ended. One that says no address is ended here. */
export async function serve(program, folder) {
  const child = spawn(program, ['serve', folder, '--port', '0'], { stdio: ['ignore', 'pipe', 'pipe'] });
  let said = '';
  const gone = new Promise((done) => child.once('exit', (code, signal) => done(signal ?? code)));
  const close = async () => {
    child.kill('SIGTERM');
    const timer = setTimeout(() => child.kill('SIGKILL'), 5000);
    await gone;
    clearTimeout(timer);
  };
  const timer = setTimeout(() => child.kill('SIGKILL'), start_ms);
  const url = await new Promise((found, fail) => {
    const read = (text) => {
      said += text;
      const address = /http:\/\/127\.0\.0\.1:\d+\//.exec(said);
      if (address) found(address[0]);
    };
    child.stdout.setEncoding('utf8').on('data', read);
    child.stderr.setEncoding('utf8').on('data', read);
    child.once('error', fail);
    gone.then((end) => fail(new Error(`${program} serve ended with ${end} before it said an address: ${said.slice(-500)}`)));
  }).finally(() => clearTimeout(timer));
  return { url, pid: child.pid, close };
}
