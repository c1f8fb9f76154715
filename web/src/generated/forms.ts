// Made by tools/gen_forms.py from src/distal/editor/messages and web/src/payload.ts: change these,
// and run it.

/** A type of JSON values; `tools/gen_forms.py` says how it is written. */
export type Form = string | readonly [string, ...unknown[]];
export type FormRecord = Readonly<Record<string, Form>>;

/** The messages of a worker. */
export const OF_WORKER: readonly string[] = ["ready", "scene", "numbers", "mistakes", "answer", "dropped", "printed", "progress"];

/** By the kind of a request: the record of its result. */
export const RESULTS: Readonly<Record<string, string>> = {"write": "Written", "count": "Counting", "time": "LineTiming", "map": "ShapeMap", "probe": "ProbeResult", "check": "Checked", "text": "EmittedText", "export": "ExportedFile", "render": "Rendered", "command": "Planned", "choices": "RenderChoices", "save": "Saved", "hello": "Greeted", "draft": "DraftAnswer", "versions": "VersionList", "version": "VersionText"};

export const FORMS: Readonly<Record<string, Form | FormRecord>> = {
  "ready": {"abilities": ["[]", "s"], "versions": ["{}", "s"], "targets": ["[]", "s"], "formats": ["[]", "s"]},
  "scene": {"id": "i", "revision": "i", "key": "s", "literals": ["|", ["[]", "SourceLiteral"], "0"], "shapes": ["|", ["[]", "ShapePlace"], "0"], "edits": ["[]", "Edit"], "ms": ["{}", "n"], "payload": "Payload", "objects": ["[]", "s"], "held": ["|", "s", "0"]},
  "SourceLiteral": {"file": "s", "line": "i", "start": "i", "end": "i", "text": "s", "type": ["=", "number", "vector", "color", "switch", "choice"], "value": ["|", "b", "n", "s", ["[]", "n"]], "parts": ["[]", ["()", "i", "i"]], "call": "s", "slot": "s", "low": ["|", "n", "0"], "high": ["|", "n", "0"], "step": "n", "whole": "b", "options": ["[]", "s"], "way": ["=", "numbers", "hold", "compile"]},
  "numbers": {"id": "i", "revision": "i", "key": "s", "literals": ["|", ["[]", "SourceLiteral"], "0"], "shapes": ["|", ["[]", "ShapePlace"], "0"], "edits": ["[]", "Edit"], "ms": ["{}", "n"], "numbers": ["{}", ["|", "Value", ["[]", ["[]", "n"]], "0"]], "parameters": ["[]", "Parameter"]},
  "ShapePlace": {"name": "s", "label": "b", "file": "s", "line": "i", "start": "i", "end": "i", "material": "s"},
  "Edit": {"file": "s", "start": "i", "end": "i", "text": "s"},
  "Value": ["|", "n", "b", ["[]", "n"]],
  "Parameter": {"name": "s", "label": "s", "kind": ["=", "slider", "integer", "toggle", "choice", "color", "point"], "default": "Value", "low": ["|", "n", "0"], "high": ["|", "n", "0"], "step": ["|", "n", "0"], "log": "b", "group": "s", "help": "s", "options": ["[]", "s"]},
  "Payload": {"format": "n", "name": "s", "code?": ["()", "s", "s"], "description": "s", "size": ["()", "n", "n"], "embed": "b", "panel": "b", "steering": ["|", ["r", {"elevation": "n", "guide?": "n", "camera?": "CameraForm"}], "0"], "time": ["r", {"start": "n", "duration": ["|", "n", "0"], "animated": "b"}], "parameters": ["[]", "Parameter"], "values": "Values", "views": ["[]", "View"], "frames?": ["r", {"passes": ["[]", ["r", {"program": "n", "name": "s"}]], "itself": ["|", ["r", {"program": "n", "name": "s"}], "0"], "keyboard": ["|", "s", "0"], "microphone": ["|", "s", "0"], "sounds": ["[]", "SoundEntry"], "images": ["[]", "ImageInput"]}], "view": "s", "poster": ["|", "s", "0"], "files": ["[]", "s"], "programs": ["|", ["r", {"encoding": ["=", "plain"], "data": ["[]", "Program"]}], ["r", {"encoding": ["=", "deflate-raw"], "data": "s"}]], "resources": ["{}", "Resource"]},
  "CameraForm": {"name": "s", "mirror": "b", "extent": ["=", "fov_deg", "height", ""]},
  "Values": ["{}", "Value"],
  "View": {"name": "s", "label": "s", "program": "n", "film?": ["r", {"trace": "n", "show": "n", "name": "s", "photons?": ["r", {"tables": ["[]", "s"], "of_sample": "n", "fewest": "n", "most": "n", "plan": "n", "deposits": "n"}]}]},
  "SoundEntry": {"name": "s", "loop": "b", "rows": "s", "file": "s"},
  "ImageInput": {"name": "s", "wrap": "s"},
  "Program": {"vertex": "s", "fragment": "s", "uniforms": ["[]", "UniformEntry"], "textures": ["[]", "TextureEntry"], "buffers": ["[]", "BufferEntry"], "trust": ["{}", "s"], "lines": ["[]", "LineRange"], "vertex_lines": ["[]", "LineRange"], "film?": "FilmPrograms", "frames?": "FrameProgram"},
  "UniformEntry": {"name": "s", "uniform": "s", "type": "s", "origin": ["=", "frame", "parameter", "number"], "default": ["|", "Value", ["[]", ["[]", "n"]], "0"]},
  "TextureEntry": {"name": "s", "uniform": "s", "type": "s", "wrap": "s"},
  "BufferEntry": {"name": "s", "uniform": "s", "count": "s", "element": "s"},
  "LineRange": ["()", "n", "n", "n", "n"],
  "FilmPrograms": {"trace": "Program", "show": "Program", "name": "s", "photons?": "PhotonPrograms"},
  "PhotonPrograms": {"plan": "Program", "deposits": "Program", "tables": ["[]", "s"], "of_sample": "n", "fewest": "n", "most": "n"},
  "FrameProgram": {"passes": ["[]", "FramePass"], "itself": ["|", "FramePass", "0"], "keyboard": ["|", "s", "0"], "microphone": ["|", "s", "0"], "sounds": ["[]", "SoundEntry"], "images": ["[]", "ImageInput"]},
  "FramePass": {"program": "Program", "name": "s"},
  "Resource": {"type": "s", "size": ["[]", "n"], "components": "n", "grey?": ["=", true], "format": "Format", "data": "s", "packed?": ["=", true]},
  "Format": ["=", "rgba8", "float16", "float32", "int32", "uint32"],
  "mistakes": {"id": "i", "revision": "i", "mistakes": ["[]", "Mistake"], "literals": ["|", ["[]", "SourceLiteral"], "0"], "edits": ["[]", "Edit"]},
  "Mistake": {"severity": ["=", "error", "warning", "note"], "code": "s", "message": "s", "hint": ["|", "s", "0"], "file": ["|", "s", "0"], "line": ["|", "i", "0"], "column": ["|", "i", "0"], "end_line": ["|", "i", "0"], "end_column": ["|", "i", "0"], "excerpt": ["|", "s", "0"], "labels": ["[]", "MistakeLabel"]},
  "MistakeLabel": {"text": "s", "file": ["|", "s", "0"], "line": ["|", "i", "0"], "column": ["|", "i", "0"], "end_line": ["|", "i", "0"], "end_column": ["|", "i", "0"], "excerpt": ["|", "s", "0"]},
  "answer": {"id": "i", "revision": "i", "request": "s", "result": "*"},
  "dropped": {"id": "i", "revision": "i"},
  "printed": {"id": "i", "revision": "i", "text": "s", "hangs": "s"},
  "progress": {"id": "i", "revision": "i", "done": "n", "label": "s", "text": "s", "remaining_s": ["|", "n", "0"]},
  "Written": {"edits": ["[]", "Edit"]},
  "Counting": {"program": "Program", "which": "s", "most": "i", "files": ["[]", "s"], "places": ["[]", ["()", "i", "i"]]},
  "LineTiming": {"program": "Program", "choice": "s", "repeats": "s", "files": ["[]", "s"], "places": ["[]", ["()", "i", "i"]], "evaluations": ["[]", "i"]},
  "ShapeMap": {"program": "Program", "files": ["[]", "s"], "parts": ["[]", ["[]", ["()", "i", "i"]]]},
  "ProbeResult": {"shape": "s", "material": "s", "file": ["|", "s", "0"], "line": ["|", "i", "0"], "point": ["[]", "n"], "normal": ["[]", "n"], "numbers": ["{}", "n"]},
  "Checked": {"mistakes": ["[]", "Mistake"]},
  "EmittedText": {"target": "s", "language": ["=", "glsl", "wgsl", "llvm", "ir"], "text": "s", "files": ["[]", "s"], "places": ["[]", ["()", "i", "i", "i", "i"]]},
  "ExportedFile": {"name": "s", "media_type": "s", "text": ["|", "s", "0"], "base64": ["|", "s", "0"], "command": "s"},
  "Rendered": {"name": "s", "bytes": "i", "address": ["|", "s", "0"], "command": "s", "said": "s"},
  "Planned": {"command": "s"},
  "RenderChoices": {"formats": ["[]", "RenderFormat"], "modes": ["[]", "s"], "qualities": ["[]", "s"], "quality": "s", "largest_side": "i", "most_samples": "i", "path_samples": "i"},
  "RenderFormat": {"name": "s", "film": "b", "bits": ["[]", "i"], "lossy": "b", "loops": "b", "missing": ["|", "s", "0"]},
  "Saved": {"digest": "s", "is_saved": "b", "conflict": ["|", "s", "0"], "problem": "s", "refusal": "s", "other": ["|", "s", "0"], "unkept": "s", "order": "i"},
  "Greeted": {"tab": "s", "drafts": ["{}", "UnsavedText"], "others": ["[]", "s"], "unkept": "s"},
  "UnsavedText": {"text": "s", "digest": "s"},
  "DraftAnswer": {"unkept": "s"},
  "VersionList": {"versions": ["[]", "VersionEntry"]},
  "VersionEntry": {"name": "s", "at": "n", "why": "s", "size": "i"},
  "VersionText": {"text": "s"},
};
