// The command that lends a device's port to the programming software (docs/programming.md). Pure.

export interface PortChoice {
  server: string;  // host:port of the bridge's `program: engineers: listen:`
  number: string;  // the device's `number:`
  port: string;  // the virtual port that is made
  user: string;  // empty: no login
  tls: boolean;
}

// As a shell takes it for one word.
export const shellWord = (text: string): string => (/^[\w@%+=:,./-]+$/.test(text) ? text : `'${text.replaceAll("'", `'\\''`)}'`);

export function portCommand({ server, number, port, user, tls }: PortChoice): string {
  const words = ['fieldcast-port', '--server', server, ...(tls ? ['--tls'] : []), ...(user ? ['--user', user] : []), '--device', number, '--link', port];
  return words.map(shellWord).join(' ');
}

// Of a host, an IPv6 address in brackets.
export const serverOf = (host: string, port = 4950): string => `${host.includes(':') ? `[${host}]` : host}:${port}`;
