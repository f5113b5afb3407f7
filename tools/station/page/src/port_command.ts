// Builds the command that connects programming software to a device's port (docs/programming.md). Pure.

export interface PortChoice {
  server: string;  // host:port of the bridge's `program: engineers: listen:`
  number: string;  // the device's `number:`
  port: string;  // the virtual port to make
  user: string;  // empty: no login
  tls: boolean;
}

// Quotes text as one word of a shell.
export const shellWord = (text: string): string => (/^[\w@%+=:,./-]+$/.test(text) ? text : `'${text.replaceAll("'", `'\\''`)}'`);

export function portCommand({ server, number, port, user, tls }: PortChoice): string {
  const words = ['fieldcast-port', '--server', server, ...(tls ? ['--tls'] : []), ...(user ? ['--user', user] : []), '--device', number, '--link', port];
  return words.map(shellWord).join(' ');
}

// Returns the host with an IPv6 address in brackets.
export const serverOf = (host: string, port = 4950): string => `${host.includes(':') ? `[${host}]` : host}:${port}`;
