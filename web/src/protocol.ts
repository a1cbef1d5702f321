/**
 * The messages between the page and the Worker that holds the core.
 *
 * ```text
 * page ── Call (with a number) ──▶ Worker ── Answer (the same number) ──▶ page
 * page ── Notice (no answer)   ──▶ Worker
 *                                  Worker ── Event ──▶ page
 * ```
 *
 * - Messages are handled in their order. An answer is for the text and the settings as all earlier messages left them.
 * - Offsets in texts are UTF-16 code units from 0, as CodeMirror counts them; line ends are `\n`. Ranges are half open.
 * - A place in a picture is in pixels of the pane's declared size (`Notices["panes"]`), from the left top corner; so
 *   are the ways of drags.
 * - Angles are radians, times milliseconds where the name does not say otherwise, colours sRGB from 0 to 255.
 * - A view is named as the command line does: `3d`, `geodesic:s`.
 * - The Worker draws by itself whatever the declared panes show: coarse while something moves, exact at rest. The page
 *   answers each `picture` with `shown`; until then the pane gets no other one.
 * - A call that cannot be done is answered with a sentence that is meant for the reader of the page.
 * - A Worker that ends (`crashed`, or a call has taken too long) has nothing that the page has not: the text, and the
 *   settings of the last `settings` event.
 */

// ---------------------------------------------------------------------------------------------------------- the text

export interface TextRange {
  from: number;
  to: number;
}

/** A piece of the text and what takes its place. */
export interface TextEdit extends TextRange {
  insert: string;
}

export type Severity = 'error' | 'warning' | 'hint';

export interface Finding extends TextRange {
  severity: Severity;
  /** The stable name of what is wrong: `undefined-name`. */
  code: string;
  message: string;
  /** A sentence that helps. */
  hint: string | null;
  /** Other places that explain it, such as the first declaration of a name. */
  related: (TextRange & { message: string })[];
}

/** The types of semantic tokens, by their numbers. */
export const TOKEN_TYPES = [
  'keyword',
  'function',
  'variable',
  'parameter',
  'number',
  'operator',
  'comment',
  'property',
  'enumMember',
] as const;

/** The modifiers of semantic tokens, by the numbers of their bits. */
export const TOKEN_MODIFIERS = [
  'declaration',
  'defaultLibrary',
  'curve',
  'surface',
  'grid',
  'param',
  'solid',
] as const;

/** Tokens in the order of the text, without overlap, four numbers each: from, to, type, bits of modifiers. */
export type Tokens = Uint32Array;

export interface Description {
  /** The language of `code`: `geotrace` or `crt`. */
  language: string;
  /** One line of code: `surface s(u, v)`. */
  code: string;
  /** Paragraphs of Markdown: inline code, emphasis, links, lists. */
  text: string[];
}

export interface Hover extends TextRange {
  description: Description;
}

export type CompletionKind =
  | 'keyword'
  | 'function'
  | 'surface'
  | 'curve'
  | 'constant'
  | 'parameter'
  | 'solid'
  | 'attribute'
  | 'word';

export interface Completion {
  label: string;
  kind: CompletionKind;
  /** A short note beside the label. */
  detail: string;
  /** The text that replaces the range. */
  insert: string;
  /** True if `insert` has places to fill in: `${1:name}`. */
  snippet: boolean;
}

/** The range is the part of the word that is already written. */
export interface Completions extends TextRange {
  list: Completion[];
  /** False if the list was cut off: ask again when more of the word is written. */
  isComplete: boolean;
}

export interface Signature {
  /** The function with its parameters: `f(x, y)`. */
  label: string;
  /** The range of each parameter in the label. */
  parameters: TextRange[];
  /** The parameter that is being written, from 0; it may lie beyond the last. */
  active: number;
  /** "surface", "builtin function". */
  what: string;
}

export interface Definition {
  /** The name at the place. */
  name: TextRange;
  /** Where it is introduced. */
  target: TextRange;
}

export interface Occurrence extends TextRange {
  introduces: boolean;
}

export interface Fix {
  /** "Write `sin(2x)`". */
  title: string;
  edits: TextEdit[];
  /** The code of the finding that it fixes. */
  code: string;
  /** True for the one that may be applied without asking. */
  preferred: boolean;
}

// --------------------------------------------------------------------------------------------------------- the scene

export type Rgb = [number, number, number];

/** What the last sound state of the text shows. */
export interface Scene {
  /** The version of the text that was compiled last. */
  version: number;
  /** True if that has errors: then some of what is shown may be out of date. */
  stale: boolean;
  /** The time that the compile took. */
  took: number;
  views: ViewInfo[];
  params: ParamInfo[];
  objects: ObjectInfo[];
  /** The declared cameras, in the order of the text. */
  cameras: string[];
  /** The words by which the text names images, and whether an image of that name is there (`Calls["texture"]`). */
  images: { word: string; isThere: boolean }[];
  /** A sentence if there is nothing to see. */
  empty: string | null;
}

export interface ViewInfo {
  /** `3d`, `geodesic:s`. */
  id: string;
  /** `3d`, `geodesic`. */
  kind: string;
  /** The object that it is of. */
  object: string | null;
  /** "3D view", "Geodesic view of s". */
  title: string;
  /** A line of help. */
  purpose: string;
  /** True if a pane opens by itself; else it waits until it is asked for. */
  opensByItself: boolean;
  /** The camera that moves it: one in space, one on a surface, or none. */
  camera: 'space' | 'inside' | null;
  /** The keys and gestures that move its camera, for a list of shortcuts. */
  keys: { keys: string; action: string }[];
  /** What can be turned on and off in its pictures (`Marks`), beyond what all views have. */
  settings: { name: string; title: string; default: boolean }[];
  /** The title of the view that its pane can show in its place (`Preferences.traced`). */
  instead: string | null;
}

export interface ParamInfo {
  name: string;
  components: ComponentInfo[];
}

export interface ComponentInfo {
  value: number;
  /** The value that the text declares. */
  initial: number;
  min: number;
  max: number;
}

export interface ObjectInfo {
  name: string;
  /** Its keyword: `surface`, `metric`, `curve`, `geodesic`, `point`, `vector`, `solid`. */
  kind: string;
  colour: Rgb;
  /** True if the colour was chosen here. */
  isColourChosen: boolean;
  /** How the text states the colour, which then cannot be chosen; numbers can be written (`Calls["writeColour"]`). */
  statedColour: 'constant' | 'expression' | null;
  hidden: boolean;
  /** True if it can have a texture: `Look.texture`, `Look.flipped`. */
  hasTexture: boolean;
  /** True if what is shown is not what the text has, since that has an error. */
  stale: boolean;
  /** Where it is declared. */
  range: TextRange | null;
}

// ------------------------------------------------------------------------------------------------------ the settings

/**
 * Everything that a reader chooses, as the native window writes it beside a program. It is what a link holds, besides
 * the text. All is by name, and everything may be absent.
 */
export interface Settings {
  looks?: Record<string, Look>;
  /** The values of params by component; `null` is the text's. */
  params?: Record<string, (number | null)[]>;
  /** The core writes these itself. */
  openings?: Record<string, { value: number; min: number; max: number }[]>;
  animations?: Record<string, { on?: boolean[]; speed?: number }>;
  /** The camera of the 3D view; if it is absent, everything is seen. */
  space?: SpaceCamera | null;
  /** The cameras of the geodesic views, by their surfaces' names. */
  inside?: Record<string, unknown>;
  /** The views that were closed, of those that open by themselves: `geodesic:s`. */
  closed?: string[];
  /** The views that were opened, of those that do not. */
  opened?: string[];
  /** The names of the images that surfaces may show. */
  textures?: string[];
  defaultTexture?: TextureChoice;
  preferences?: Preferences;
}

export interface Look {
  colour?: Rgb | null;
  texture?: TextureChoice;
  flipped?: boolean;
  hidden?: boolean;
}

/** An image is named as it was given to `Calls["texture"]`. */
export type TextureChoice = 'default' | 'plain' | 'curvature' | { image: string };

export interface SpaceCamera {
  eye: [number, number, number];
  target: [number, number, number];
  radius: number;
  moved?: boolean;
  tangent?: number;
}

export interface Preferences {
  /** 1 by default. */
  cameraSpeed?: number;
  background?: Rgb | null;
  theme?: 'system' | 'light' | 'dark';
  /** The side of pictures in pixels; that of their panes if absent. */
  spaceSize?: number | null;
  insideSize?: number | null;
  marks?: Marks;
  /** True if a drag in space turns the camera where it stands. */
  fly?: boolean;
  orthographic?: boolean;
  /** True if the pane of the 3D view shows the traced view. */
  traced?: boolean;
  /** The declared camera where the 3D view opens. */
  camera?: string | null;
  /** The samples to which a pixel of a traced picture at rest is refined, 1 to 4096. */
  samples?: number;
  writeOnRelease?: boolean;
  runTimes?: boolean;
  /** The scale of the page's controls. */
  scale?: number;
}

/** The overlays of pictures; besides these, the `ViewInfo.settings` by their names. */
export interface Marks {
  legend?: boolean;
  wavefronts?: boolean;
  conjugate?: boolean;
  cutLocus?: boolean;
  error?: boolean;
  labels?: boolean;
  axes?: boolean;
  cameras?: boolean;
  trail?: boolean;
  [setting: string]: boolean | undefined;
}

/**
 * A change of the settings, as a JSON merge patch (RFC 7396): objects are merged, `null` removes, all else is
 * replaced. `{ preferences: { marks: { legend: true } } }`, `{ params: { r: [1.5] } }`.
 */
export type SettingsPatch = { [key: string]: unknown };

// -------------------------------------------------------------------------------------------------------- the pictures

/** A pane on the page. */
export interface Pane {
  view: string;
  /** The pixels that it has room for: its CSS size times the device's pixel ratio, 1 to 4096. */
  width: number;
  height: number;
}

export interface Picture {
  view: string;
  /** The size of `pixels`; smaller than the pane's where the picture is coarse. Show it as large as the pane. */
  width: number;
  height: number;
  /** RGBA, top row first, opaque. */
  pixels: ArrayBuffer;
  /** False if a finer one follows when nothing moves. */
  exact: boolean;
  /** The version of the text that it shows. */
  version: number;
  /** Of a traced picture, the samples of each pixel so far and those that are wanted. */
  samples: [number, number] | null;
  /** Sentences for the reader: "`p` is undefined at the current params and is not drawn". */
  notes: string[];
  /** The camera's place in words: "from (u, v) = (0.000, 3.142), 2.000 from centre to edge". */
  place: string | null;
  took: number;
}

/** Why a pane has no picture. */
export interface NoPicture {
  view: string;
  /** A sentence. */
  message: string;
}

/** A use of the pointer; a view of which the camera is inside a surface always walks. */
export type Grip = 'orbit' | 'look' | 'pan';

/** A key that moves cameras while it is held; the letters by their places on a US keyboard (`KeyboardEvent.code`). */
export type CameraKey =
  | 'w'
  | 'a'
  | 's'
  | 'd'
  | 'q'
  | 'e'
  | 'z'
  | 'x'
  | 'left'
  | 'right'
  | 'up'
  | 'down'
  | 'plus'
  | 'minus';

/** `frame` shows everything from the present direction, `reset` puts the camera at its first place. */
export type CameraMove = 'reset' | 'frame' | '+x' | '-x' | '+y' | '-y' | '+z' | '-z';

/** What is seen at a place of a picture. */
export interface Pick {
  object: string;
  /** Its keyword. */
  kind: string;
  /** Its instance, from 0, where a grid makes several. */
  instance: number;
  /** The place in space, in the scene's units; `null` on a metric. */
  position: [number, number, number] | null;
  /** (u, v) of a surface, (t) of a curve, otherwise empty. */
  parameters: number[];
  /** In a geodesic view, length and angle of the pixel's geodesic. */
  polar: [number, number] | null;
  /** Of a surface: (u, v), the curvature K, the distance from its geodesic camera, in words. */
  rows: { name: string; value: string }[];
  /** In one line: "s at (u, v) = (0.1, 2), K = 0.25". */
  text: string;
  /** Where what is seen is declared: of a solid that is made of parts, the part. */
  range: TextRange | null;
}

export interface SavedFile {
  bytes: ArrayBuffer;
  /** `image/png`, `model/gltf-binary`. */
  type: string;
  notes: string[];
}

export type MeshFormat = 'obj' | 'ply' | 'stl' | 'gltf' | 'glb';

/** A figure whose measures are asked for: places on a surface or metric. */
export interface Figure {
  surface: string;
  kind: 'place' | 'distance' | 'circle' | 'triangle';
  /** (u, v) each: 1, 2, 2 (the second is on the circle; 1 with a radius), 3. A circle's missing first one is the camera's place. */
  places: [number, number][];
  /** Of a circle. */
  radius?: number;
}

export interface Measured {
  rows: { name: string; value: string }[];
  note: string | null;
  /** The figure's places, with the one that was missing. */
  places: [number, number][];
}

// -------------------------------------------------------------------------------------------------------- the messages

/** What is asked for, and what is answered. */
export interface Calls {
  /** Opens a program; the extension of the name, `.gtr` or `.crt`, chooses the language. */
  open: {
    params: { name: string; text: string; version: number; settings?: Settings };
    result: { language: string; lineComment: string | null };
  };

  tokens: { params: TextRange; result: Tokens };
  hover: { params: { at: number }; result: Hover | null };
  complete: { params: { at: number }; result: Completions };
  /** The description of an entry of the list at a place. */
  describe: { params: { at: number; label: string }; result: Description | null };
  signature: { params: { at: number }; result: Signature | null };
  definition: { params: { at: number }; result: Definition | null };
  occurrences: { params: { at: number }; result: Occurrence[] };
  /** The name at a place, if it can be renamed; else a sentence. */
  prepareRename: { params: { at: number }; result: TextRange & { name: string } };
  rename: { params: { at: number; name: string }; result: TextEdit[] };
  /** The edits that lay out the text, or the declarations that touch a range. */
  format: { params: { range: TextRange | null }; result: TextEdit[] };
  fixes: { params: TextRange; result: Fix[] };
  /** All fixes that may be applied without asking, and their number. */
  fixAll: { params: Record<string, never>; result: { edits: TextEdit[]; count: number } };
  /** Where an object is declared. */
  declaration: { params: { name: string }; result: TextRange | null };
  /** The edit after which a param starts with its present value. */
  writeParam: { params: { param: string }; result: TextEdit };
  /** The edit after which a camera of the text stands where the 3D view's camera is; it is added if it is not there. */
  writeCamera: { params: { name: string }; result: TextEdit };
  /** The edit after which an object that states its colour as numbers has another one. */
  writeColour: { params: { object: string; rgb: Rgb }; result: TextEdit };

  /** All settings as they are now. */
  settings: { params: Record<string, never>; result: Settings };
  /** Takes back the last step, or does it again; the name of the step, `null` if there is none. */
  undo: { params: Record<string, never>; result: string | null };
  redo: { params: Record<string, never>; result: string | null };

  /**
   * What is seen at a place of a pane. For measuring, the surface under a line is meant, and a declared point or end of a
   * geodesic near the place is taken in its stead.
   */
  pick: { params: { view: string; at: [number, number]; measures?: boolean }; result: Pick | null };
  /**
   * A click: puts the geodesic camera of what is seen there at that place, if it can have one (`placed` is then the
   * geodesic view that shows it).
   */
  click: {
    params: { view: string; at: [number, number] };
    result: { pick: Pick; placed: string | null } | null;
  };
  /** A double click: its first half, which was a `click`, is withdrawn. Its use is the declaration: `Pick.range`. */
  doubleClick: { params: { view: string; at: [number, number] }; result: Pick | null };
  /** Measures a figure. Its lines are shown until another one is measured; `null` is none. */
  measure: { params: { figure: Figure | null }; result: Measured };
  /** Measures the walk of the geodesic camera that was used last: there is one where trails are shown. */
  measureWalk: { params: Record<string, never>; result: Measured };
  /** Leads that camera back to the start of its walk, along the shortest geodesic. */
  walkBack: { params: Record<string, never>; result: null };

  /** Takes an image (PNG or JPEG) under a name; the sizes in pixels that it has as a texture. */
  texture: { params: { name: string; bytes: ArrayBuffer }; result: { width: number; height: number } };
  /** A pane as it is at rest, in a size of its own, as a PNG file. */
  savePicture: { params: { view: string; width: number; height: number }; result: SavedFile };
  /** The objects that are not hidden as a file of a format. */
  saveMesh: { params: { format: MeshFormat }; result: SavedFile };
}

/** What is told, and not answered. */
export interface Notices {
  /**
   * Edits of the text: ranges of the text of version `version - 1`, in their order and without overlap, as CodeMirror's
   * `ChangeSet.iterChanges` has them. A gap between versions is answered by the event `resync`.
   */
  edit: { version: number; changes: TextEdit[] };
  /** The whole text anew: the answer to `resync`. */
  text: { version: number; text: string };
  /** The place of the cursor: the object that is declared there is set off for a moment. `null` if it is in no text. */
  cursor: { at: number | null };

  /** All settings, in the place of those that are there. */
  replaceSettings: { settings: Settings };
  /** A change of the settings. Those with the same `step` in a row are undone together; without it none is undone. */
  change: { patch: SettingsPatch; step?: string };
  /** True if the page is light; it decides the background of the 3D view where none is chosen. */
  light: { isLight: boolean };

  /** All panes that are on the screen. */
  panes: { panes: Pane[] };
  /** The picture of a pane has been put on the screen. */
  shown: { view: string };
  /** The surface whose geodesic camera the 3D view shows: that of the pane with the focus. */
  focus: { view: string | null };

  /** A drag by so many pixels to the right and down. */
  drag: { view: string; grip: Grip; by: [number, number] };
  /** Wheel or pinch about a place: nearer by a factor below 1, farther by one above. */
  zoom: { view: string; at: [number, number]; factor: number };
  /** Two fingers that turn, clockwise. */
  twist: { view: string; angle: number };
  /** The keys that are held from now on; the Worker moves the camera until they are released. */
  hold: { view: string; keys: CameraKey[]; shift: boolean; alt: boolean };
  camera: { view: string; move: CameraMove };
  /** The gesture has ended: the next motion is another step for undo, and an exact picture follows. */
  release: Record<string, never>;
}

export interface Events {
  /**
   * The core is there; the first message. The time from the Worker's start, the number of threads that draw, and the name
   * of the broadcast channel on which one of them says why it has failed: the Worker itself waits for it for ever then.
   */
  ready: { took: number; threads: number; channel: string };
  /** Findings of a text, sorted by place. */
  findings: { version: number; findings: Finding[] };
  /** Another scene, or other values or looks in it. */
  scene: Scene;
  /** The Worker has changed settings by itself: a camera has come to rest, a text has another value for a param. */
  settings: { settings: Settings };
  picture: Picture;
  noPicture: NoPicture;
  /** Something moves by itself: the page need not ask, but may say so. */
  busy: { view: string | null; isBusy: boolean };
  /** The Worker does not have the text that an edit is of: send `text`. */
  resync: { version: number };
  /** The core has failed and the Worker is of no use any more: end it, and start another one. */
  crashed: { message: string };
}

export type CallName = keyof Calls;
export type NoticeName = keyof Notices;
export type EventName = keyof Events;

export type ToWorker =
  | { [K in CallName]: { call: K; id: number; params: Calls[K]['params'] } }[CallName]
  | { [K in NoticeName]: { notice: K; params: Notices[K] } }[NoticeName];

export type FromWorker =
  | { answer: number; result: unknown }
  | { answer: number; error: string }
  | { [K in EventName]: { event: K; params: Events[K] } }[EventName];

// ------------------------------------------------------------------------------------------------------ the page's end

/** Something that messages can be posted to: a Worker. */
export interface Port {
  postMessage(message: ToWorker, transfer: Transferable[]): void;
}

/** The page's end of the connection: give it every message of the Worker. */
export class Connection {
  private next = 1;
  private waiting = new Map<number, { resolve(value: never): void; reject(reason: Error): void }>();

  constructor(
    private readonly port: Port,
    private readonly on: { [K in EventName]?: (params: Events[K]) => void },
  ) {}

  /** Asks; refused with an `Error` whose message is a sentence for the reader. */
  call<K extends CallName>(
    call: K,
    params: Calls[K]['params'],
    transfer: Transferable[] = [],
  ): Promise<Calls[K]['result']> {
    const id = this.next++;
    return new Promise((resolve, reject) => {
      this.waiting.set(id, { resolve, reject });
      this.port.postMessage({ call, id, params } as ToWorker, transfer);
    });
  }

  tell<K extends NoticeName>(notice: K, params: Notices[K]): void {
    this.port.postMessage({ notice, params } as ToWorker, []);
  }

  receive(message: FromWorker): void {
    if ('event' in message) {
      const on = this.on[message.event] as ((params: unknown) => void) | undefined;
      on?.(message.params);
      return;
    }
    const waiting = this.waiting.get(message.answer);
    this.waiting.delete(message.answer);
    if ('error' in message) waiting?.reject(new Error(message.error));
    else waiting?.resolve(message.result as never);
  }

  /** Refuses all that is asked for: the Worker has ended. */
  close(): void {
    for (const { reject } of this.waiting.values()) reject(new Error('the core was started again'));
    this.waiting.clear();
  }
}
