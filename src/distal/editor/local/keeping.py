"""What the server keeps for a tab: its drafts, and the versions of files.

Input: requests of the app. Output: their answers. A text that cannot be kept is said in the answer.
"""

from __future__ import annotations

from distal.diagnostics import LoadError
from distal.editor.local.drafts import Draft, Drafts
from distal.editor.local.files import SceneFiles, version_text
from distal.editor.local.source_file import LONGEST_FILE
from distal.editor.messages import (
    Answer,
    DraftAnswer,
    DraftRequest,
    Greeted,
    HelloRequest,
    Message,
    Mistake,
    Mistakes,
    UnsavedText,
    VersionEntry,
    VersionList,
    VersionRequest,
    VersionsRequest,
    VersionText,
)
from distal.editor.scene_folder import check_name

Request = HelloRequest | DraftRequest | VersionsRequest | VersionRequest
_NOWHERE = "nothing is kept here"


class TabKeeping:
    """The drafts and versions of one tab.

    Args:
        files: The files.
    """

    def __init__(self, files: SceneFiles) -> None:
        self._files = files
        self._tab = ""

    def answered(self, request: Request) -> list[Message]:
        """Return the answer to a request, after what the app must know before it."""
        self._before: list[Message] = []
        try:
            if not isinstance(request, HelloRequest):
                check_name(request.file)
            result = self._result(request)
        except (LoadError, OSError) as error:
            reason = error.reason if isinstance(error, LoadError) else str(error)
            return [refusal(request.id, request.revision, reason)]
        return [*self._before, Answer(**request.numbers, request=request.kind, result=result)]

    def end(self) -> None:
        """Note that the tab is gone."""
        drafts = self._files.drafts
        if drafts is not None and self._tab:
            drafts.left(self, self._tab)

    def _result(self, request: Request) -> Greeted | DraftAnswer | VersionList | VersionText:
        drafts = self._files.drafts
        if isinstance(request, HelloRequest):
            return self._greeted(drafts, request)
        if isinstance(request, DraftRequest):
            return self._kept(drafts, request)
        if drafts is None:
            raise LoadError(_NOWHERE)
        name = request.file
        if isinstance(request, VersionRequest):
            return VersionText(text=version_text(drafts.versions.read(name, request.version)))
        entries = (
            VersionEntry(name=v.path.name, at=1000.0 * v.at, why=v.why, size=v.size)
            for v in drafts.versions.all(name)
        )
        return VersionList(versions=tuple(entries))

    def _greeted(self, drafts: Drafts | None, request: HelloRequest) -> Greeted:
        if drafts is None:
            return Greeted(tab="", drafts={}, others=(), unkept=_NOWHERE)
        if self._tab:
            drafts.left(self, self._tab)
        self._tab = tab = drafts.entered(self, request.tab, is_new=request.is_new)
        unkept, others = self._files.unkept, list[str]()
        offered: dict[str, Draft] = {}
        try:
            offered, others = drafts.offered(tab, is_new=request.is_new)
            for name, text in self._files.taken_unsaved().items() if request.is_new else ():
                if name not in offered:
                    offered[name] = Draft(text, "", 0.0)
                    drafts.put(tab, name, text, "")
        except OSError as error:
            unkept = drafts.reason(error)
        changed = self._files.included(offered)
        if changed is not None:
            self._before.append(changed)
        texts = {n: UnsavedText(text=draft.text, digest=draft.base) for n, draft in offered.items()}
        return Greeted(tab=tab, drafts=texts, others=tuple(others), unkept=unkept)

    def _kept(self, drafts: Drafts | None, request: DraftRequest) -> DraftAnswer:
        if drafts is None:
            return DraftAnswer(unkept=_NOWHERE)
        self._tab = self._tab or drafts.entered(self)
        name, text = request.file, request.text
        try:
            if text is None:
                drafts.drop(self._tab, name, self._files.text_of(name))
            elif len(text) > LONGEST_FILE:
                return DraftAnswer(unkept=f"it has more than {LONGEST_FILE:,} characters")
            else:
                drafts.put(self._tab, name, text, request.digest)
        except OSError as error:
            return DraftAnswer(unkept=drafts.reason(error))
        return DraftAnswer()


def refusal(id: int, revision: int, text: str) -> Mistakes:
    """Return the answer to what cannot be done."""
    mistakes = (Mistake(severity="error", message=text),)
    return Mistakes(id=id, revision=revision, mistakes=mistakes)
