// Starts the program with its live page on a free port.
import { spawn } from "node:child_process";

/** Runs `program` and waits for the address it prints. */
export async function startProgram(program, args) {
  const child = spawn(program, args, { stdio: ["pipe", "pipe", "pipe"] });
  let output = "";
  const exited = new Promise((resolve) => {
    child.on("error", (error) => resolve({ code: -1, output: String(error) }));
    child.on("close", (code) => resolve({ code, output }));
  });
  const url = await new Promise((resolve, reject) => {
    const read = (chunk) => {
      output += chunk;
      process.stderr.write(chunk); // a test that fails shows what the program had to say
      const address = /http:\/\/127\.0\.0\.1:(\d+)/.exec(output);
      if (address) resolve(address[0]);
    };
    child.stdout.on("data", read);
    child.stderr.on("data", read);
    exited.then((end) => reject(new Error(`${program} ended with ${end.code}:\n${end.output}`)));
  });
  return {
    url,
    pid: child.pid,
    /** A line to its standard input. */
    tell: (line) => child.stdin.write(`${line}\n`),
    /** Ends it as Ctrl-C does; resolves with its exit status. */
    async stop() {
      child.kill("SIGINT");
      const giveUp = setTimeout(() => child.kill("SIGKILL"), 20_000);
      const { code } = await exited;
      clearTimeout(giveUp);
      return code;
    },
  };
}
