// What every page is given, and what it gives back.

import type { Live } from './live';
import type { Plant, Topic } from './plant';
import type { Route } from './router';
import type { Me } from './types';

// What happened since the last painting.
export interface Change {
  values: boolean;  // some value
  second: boolean;  // ages want to be shown anew
  topics: ReadonlySet<Topic>;
}

export interface Context {
  plant: Plant;
  live: Live;
  me: Me;
  route: Route;
  now(): number;  // the station's clock, Unix ms
  mayOperate(): boolean;  // the role allows writing and acknowledging
  go(address: string): void;  // '#/live'
  say(text: string, bad?: boolean): void;  // a short message that goes away
}

export interface Page {
  title: string;
  element: HTMLElement;
  paint?(change: Change): void;  // inside an animation frame; everything is to be painted at the first call
  key?(event: KeyboardEvent): boolean;  // true: taken
  focusFilter?(): void;  // the key /
  close?(): void;
}

export type MakePage = (context: Context) => Page;
