// Builds the command that connects programming software to a device's port (docs/programming.md). Pure.

export interface PortChoice {
  server: string;  // host:port of the bridge's `program: engineers: listen:`
  number: string;  // the device's `number:`
  port: string;  // the virtual port to make; on Windows the COM port to open: COM5
  user: string;  // empty: no login
  tls: boolean;
}

// Quotes text as one word of a shell.
export const shellWord = (text: string): string => (/^[\w@%+=:,./-]+$/.test(text) ? text : `'${text.replaceAll("'", `'\\''`)}'`);

// The same for the command prompt of Windows.
const promptWord = (text: string): string => (/^[\w@+:,./-]+$/.test(text) ? text : `"${text.replaceAll(/["%]/g, '')}"`);

// The password is in a file of the engineer's PC, so that no command line has it.
export function portCommand({ server, number, port, user, tls }: PortChoice): string {
  const windows = /^COM\d+$/i.test(port);
  const words = ['--server', server, ...(tls ? ['--tls'] : []), ...(user ? ['--user', user, '--password-file', `${user}.password`] : []), '--device', number];
  return ['fieldcast-port', ...(windows ? ['connect', ...words, '--port', port] : [...words, '--link', port])].map(windows ? promptWord : shellWord).join(' ');
}

// Returns the host with an IPv6 address in brackets.
export const serverOf = (host: string, port = 4950): string => `${host.includes(':') ? `[${host}]` : host}:${port}`;
