"""Draw a frame, and the panels over it, on a window.

Input: a canvas of rendercanvas, a device of wgpu, a frame, panels. Output: pixels on the screen,
identical to the frame's if the sizes agree. Contains no color formula: if the surface encodes what
is written to it, textures have the format that decodes when read.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.window.frame_renderers import TEXTURE_FORMAT, RenderedFrame
from distal.window.panels import Panel

_SHADER: Final = """
@group(0) @binding(0) var image: texture_2d<f32>;
@group(0) @binding(1) var look: sampler;

struct Corner {
    @builtin(position) position: vec4f,
    @location(0) uv: vec2f,
}

@vertex
fn corner(@builtin(vertex_index) index: u32) -> Corner {
    let uv = vec2f(f32((index << 1u) & 2u), f32(index & 2u));
    return Corner(vec4f(uv.x * 2.0 - 1.0, 1.0 - uv.y * 2.0, 0.0, 1.0), uv);
}

@fragment
fn whole(at: Corner) -> @location(0) vec4f {
    return vec4f(textureSample(image, look, at.uv).rgb, 1.0);
}

@fragment
fn over(at: Corner) -> @location(0) vec4f {
    return textureSample(image, look, at.uv);
}
"""


class WindowSurface:
    """The surface of a window, ready for drawing.

    Attributes:
        format: The format of the surface.
    """

    def __init__(self, canvas: Any, device: Any) -> None:
        self._device = device
        self._context = canvas.get_context("wgpu")
        self.format = self._configured()
        encodes = self.format.endswith("-srgb")
        self._read_format = f"{TEXTURE_FORMAT}-srgb" if encodes else TEXTURE_FORMAT
        module = device.create_shader_module(code=_SHADER)
        self._whole = self._pipeline(module, "whole", None)
        add = {"operation": "add", "src_factor": "src-alpha", "dst_factor": "one-minus-src-alpha"}
        self._over = self._pipeline(module, "over", {"color": add, "alpha": add})
        self._exact = device.create_sampler(min_filter="nearest", mag_filter="nearest")
        self._smooth = device.create_sampler(min_filter="linear", mag_filter="linear")
        self._frame: Any = None
        self._is_own = False  # whether the frame is a texture made here
        self._panels: dict[int, tuple[Panel, Any]] = {}

    def show(self, made: RenderedFrame) -> None:
        """Use a frame as the picture from now on."""
        if made.texture is not None:
            self._frame, self._is_own = self._readable(made.texture), False
            return
        assert made.pixels is not None
        height, width = made.pixels.shape[:2]
        if not self._is_own or self._frame.size[:2] != (width, height):
            self._frame, self._is_own = self._texture(width, height), True
        self._upload(self._frame, made.pixels)

    def draw(self, panels: Sequence[Panel]) -> None:
        """Draw the picture over the whole window, and the panels over it, the lowest first."""
        target = self._context.get_current_texture()
        width, height = target.size[:2]
        textures = [(panel, self._panel_texture(panel)) for panel in panels]
        self._panels = {id(panel): (panel, texture) for panel, texture in textures}
        encoder = self._device.create_command_encoder()
        attachment = {
            "view": target.create_view(),
            "load_op": "clear",
            "store_op": "store",
            "clear_value": (0, 0, 0, 1),
        }
        draws = encoder.begin_render_pass(color_attachments=[attachment])
        if self._frame is not None:
            fits = self._frame.size[:2] == (width, height)
            self._put(draws, self._whole, self._frame, self._exact if fits else self._smooth)
        for panel, texture in textures:
            # A viewport must not extend beyond the window.
            draws.set_scissor_rect(0, 0, width, height)
            across, down = texture.size[:2]
            if panel.x + across > width or panel.y + down > height:
                continue  # the window was made smaller; panels of the next drawing will fit
            draws.set_viewport(panel.x, panel.y, across, down, 0, 1)
            self._put(draws, self._over, texture, self._exact)
        draws.end()
        self._device.queue.submit([encoder.finish()])

    def _configured(self) -> str:
        """Configure the surface to store values unchanged if it can; return its format."""
        preferred = str(self._context.get_preferred_format(self._device.adapter))
        for format in (preferred.removesuffix("-srgb"), preferred):
            try:
                self._context.configure(device=self._device, format=format, alpha_mode="opaque")
            except ValueError:  # this surface supports only formats that encode
                if format == preferred:
                    raise
                continue
            break
        return format

    def _readable(self, texture: Any) -> Any:
        """Return the texture, or a copy in the format that decodes when read."""
        if texture.format == self._read_format:
            return texture
        width, height = texture.size[:2]
        copy = self._texture(width, height)
        encoder = self._device.create_command_encoder()
        places = {"texture": texture}, {"texture": copy}
        encoder.copy_texture_to_texture(*places, (width, height, 1))
        self._device.queue.submit([encoder.finish()])
        return copy

    def _put(self, draws: Any, pipeline: Any, texture: Any, sampler: Any) -> None:
        view = texture.create_view()
        group = self._device.create_bind_group(
            layout=pipeline.get_bind_group_layout(0),
            entries=[{"binding": 0, "resource": view}, {"binding": 1, "resource": sampler}],
        )
        draws.set_pipeline(pipeline)
        draws.set_bind_group(0, group)
        draws.draw(3)

    def _panel_texture(self, panel: Panel) -> Any:
        known = self._panels.get(id(panel))
        if known is not None and known[0] is panel:
            return known[1]
        height, width = panel.pixels.shape[:2]
        texture = self._texture(width, height)
        self._upload(texture, panel.pixels)
        return texture

    def _texture(self, width: int, height: int) -> Any:
        return self._device.create_texture(
            size=(width, height, 1),
            format=self._read_format,
            usage="COPY_DST|TEXTURE_BINDING",
        )

    def _upload(self, texture: Any, pixels: NDArray[np.uint8]) -> None:
        height, width = pixels.shape[:2]
        self._device.queue.write_texture(
            {"texture": texture},
            np.ascontiguousarray(pixels),
            {"bytes_per_row": width * 4, "rows_per_image": height},
            (width, height, 1),
        )

    def _pipeline(self, module: Any, fragment: str, blend: dict[str, Any] | None) -> Any:
        target: dict[str, Any] = {"format": self.format}
        if blend is not None:
            target["blend"] = blend
        return self._device.create_render_pipeline(
            layout="auto",
            vertex={"module": module, "entry_point": "corner"},
            primitive={"topology": "triangle-list"},
            fragment={"module": module, "entry_point": fragment, "targets": [target]},
        )
