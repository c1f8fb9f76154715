"""Reserved words of the targets.

A name of the author that is a reserved word is changed (``distal.backends.clike.names``). The GLSL
lists are the union over all supported versions, so that a function has the same name in each.

Sources: The OpenGL ES Shading Language 3.00.6, sections 3.8 (keywords) and 8 (functions); 1.00.17,
sections 3.6 and 8; The OpenGL Shading Language 3.30.6, sections 3.6 and 8; and the words that 4.60
section 3.6 added, because drivers for newer versions warn of them. WebGPU Shading Language,
sections "Keyword Summary", "Reserved Words", "Predeclared Types", "Enumeration Types" and "Built-in
Functions" (https://www.w3.org/TR/WGSL/).
"""

from __future__ import annotations

from typing import Final


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


def _sized(*stems: str, sizes: str = "234") -> frozenset[str]:
    return frozenset(stem + size for stem in stems for size in sizes)


_MATRIX_SIZES: Final = tuple(f"{columns}x{rows}" for columns in "234" for rows in "234")

# image2D isampler2DArray usamplerCube ...
_GLSL_OPAQUE: Final = frozenset(
    prefix + stem + shape
    for prefix in ("", "i", "u")
    for stem in ("sampler", "image")
    for shape in (
        *("1D", "2D", "3D", "Cube", "2DRect", "Buffer", "1DArray", "2DArray", "CubeArray"),
        *("2DMS", "2DMSArray"),
    )
) | _words(
    """sampler1DShadow sampler2DShadow samplerCubeShadow sampler2DRectShadow sampler1DArrayShadow
    sampler2DArrayShadow samplerCubeArrayShadow sampler3DRect samplerExternalOES"""
)

_GLSL_WORDS: Final = _words(
    """
    attribute const uniform varying buffer shared coherent volatile restrict readonly writeonly
    atomic_uint layout centroid flat smooth noperspective patch sample invariant precise break
    continue do for while switch case default if else subroutine in out inout int void bool true
    false float double discard return uint lowp mediump highp precision struct
    common partition active asm class union enum typedef template this resource goto inline
    noinline public static extern external interface long short half fixed unsigned superp input
    output filter sizeof cast namespace using packed row_major defined
    """
)

# gl_, GL_: names and macros of the language (GL_ES is 1). webgl_, _webgl_: the WebGL specification,
# "Supported GLSL Constructs".
GLSL_PREFIXES: Final = ("gl_", "GL_", "webgl_", "_webgl_")

GLSL_KEYWORDS: Final = (
    _GLSL_WORDS
    | _GLSL_OPAQUE
    | _sized("vec", "ivec", "uvec", "bvec", "dvec", "hvec", "fvec", "mat", "dmat")
    | {f"{stem}{size}" for stem in ("mat", "dmat") for size in _MATRIX_SIZES}
)

# The method of arrays: glslang treats every ``.length`` as this method, even of a struct.
GLSL_METHODS: Final = frozenset({"length"})

GLSL_FUNCTIONS: Final = _words(
    """
    radians degrees sin cos tan asin acos atan sinh cosh tanh asinh acosh atanh pow exp log exp2
    log2 sqrt inversesqrt abs sign floor trunc round roundEven ceil fract mod modf min max clamp
    mix step smoothstep isnan isinf floatBitsToInt floatBitsToUint intBitsToFloat uintBitsToFloat
    fma frexp ldexp packSnorm2x16 unpackSnorm2x16 packUnorm2x16 unpackUnorm2x16 packHalf2x16
    unpackHalf2x16 packUnorm4x8 packSnorm4x8 unpackUnorm4x8 unpackSnorm4x8 packDouble2x32
    unpackDouble2x32 length distance dot cross normalize ftransform faceforward reflect refract
    matrixCompMult outerProduct transpose determinant inverse lessThan lessThanEqual greaterThan
    greaterThanEqual equal notEqual any all not uaddCarry usubBorrow umulExtended imulExtended
    bitfieldExtract bitfieldInsert bitfieldReverse bitCount findLSB findMSB textureSize
    textureQueryLod textureQueryLevels texture textureProj textureLod textureOffset texelFetch
    texelFetchOffset textureProjOffset textureLodOffset textureProjLod textureProjLodOffset
    textureGrad textureGradOffset textureProjGrad textureProjGradOffset textureGather
    textureGatherOffset texture1D texture1DProj texture1DLod texture2D texture2DProj texture2DLod
    texture2DProjLod texture3D texture3DProj texture3DLod textureCube textureCubeLod shadow1D
    shadow2D texture2DRect texture2DGradEXT texture2DLodEXT dFdx dFdy fwidth dFdxFine dFdyFine
    fwidthFine interpolateAtCentroid interpolateAtSample interpolateAtOffset noise1 noise2 noise3
    noise4 EmitVertex EndPrimitive barrier memoryBarrier groupMemoryBarrier imageLoad imageStore
    imageSize atomicAdd atomicMin atomicMax atomicAnd atomicOr atomicXor atomicExchange
    atomicCompSwap atomicCounter main mainImage mainSound mainVR
    absoluteDifference addSaturate average averageRounded countLeadingZeros countTrailingZeros
    multiply32x16 subtractSaturate
    """
)

WGSL_KEYWORDS: Final = _words(
    """
    alias break case const const_assert continue continuing default diagnostic discard else enable
    false fn for if let loop override requires return struct switch true var while

    NULL Self abstract active alignas alignof as asm asm_fragment async attribute auto await become
    cast catch class co_await co_return co_yield coherent column_major common compile
    compile_fragment concept const_cast consteval constexpr constinit crate debugger decltype
    delete demote demote_to_helper do dynamic_cast enum explicit export extends extern external
    fallthrough filter final finally friend from fxgroup get goto groupshared highp impl implements
    import inline instanceof interface layout lowp macro macro_rules match mediump meta mod module
    move mut mutable namespace new nil noexcept noinline nointerpolation non_coherent noncoherent
    noperspective null nullptr of operator package packoffset partition pass patch pixelfragment
    precise precision premerge priv protected pub public readonly ref regardless register
    reinterpret_cast require resource restrict self set shared sizeof smooth snorm static
    static_assert static_cast std subroutine super target template this thread_local throw trait
    try type typedef typeid typename typeof union unless unorm unsafe unsized use using varying
    virtual volatile wgsl where with writeonly yield
    """
)

# Not keywords, but a declaration could shadow them and change the meaning of later text.
WGSL_PREDECLARED: Final = (
    _words(
        """
        bool f16 f32 i32 u32 array atomic ptr sampler sampler_comparison read write read_write
        function private workgroup uniform storage handle

        bitcast all any select arrayLength abs acos acosh asin asinh atan atanh atan2 ceil clamp
        cos cosh countLeadingZeros countOneBits countTrailingZeros cross degrees determinant
        distance dot dot4U8Packed dot4I8Packed exp exp2 extractBits faceForward firstLeadingBit
        firstTrailingBit floor fma fract frexp insertBits inverseSqrt ldexp length log log2 max min
        mix modf normalize pow quantizeToF16 radians reflect refract reverseBits round saturate
        sign sin sinh smoothstep sqrt step tan tanh transpose trunc dpdx dpdxCoarse dpdxFine dpdy
        dpdyCoarse dpdyFine fwidth fwidthCoarse fwidthFine textureDimensions textureGather
        textureGatherCompare textureLoad textureNumLayers textureNumLevels textureNumSamples
        textureSample textureSampleBias textureSampleCompare textureSampleCompareLevel
        textureSampleGrad textureSampleLevel textureSampleBaseClampToEdge textureStore atomicLoad
        atomicStore atomicAdd atomicSub atomicMax atomicMin atomicAnd atomicOr atomicXor
        atomicExchange atomicCompareExchangeWeak pack4x8snorm pack4x8unorm pack4xI8 pack4xU8
        pack4xI8Clamp pack4xU8Clamp pack2x16snorm pack2x16unorm pack2x16float unpack4x8snorm
        unpack4x8unorm unpack4xI8 unpack4xU8 unpack2x16snorm unpack2x16unorm unpack2x16float
        storageBarrier textureBarrier workgroupBarrier workgroupUniformLoad subgroupAdd
        subgroupAll subgroupAnd subgroupAny subgroupBallot subgroupBroadcast subgroupElect
        subgroupMax subgroupMin subgroupMul subgroupOr subgroupShuffle subgroupXor quadBroadcast
        texture_1d texture_2d texture_2d_array texture_3d texture_cube texture_cube_array
        texture_multisampled_2d texture_external texture_depth_2d texture_depth_2d_array
        texture_depth_cube texture_depth_cube_array texture_depth_multisampled_2d
        texture_storage_1d texture_storage_2d texture_storage_2d_array texture_storage_3d
        """
    )
    | _sized("vec")
    | {f"vec{size}{letter}" for size in "234" for letter in "fhiu"}
    | {f"mat{size}{letter}" for size in _MATRIX_SIZES for letter in ("", "f", "h")}
)

# Names that a host declares before the text, and macros that a host replaces in it.
SHADERTOY_NAMES: Final = _words(
    """
    iResolution iTime iTimeDelta iFrame iFrameRate iChannelTime iChannelResolution iMouse iDate
    iSampleRate iBlockOffset iChannel0 iChannel1 iChannel2 iChannel3 iCh0 iCh1 iCh2 iCh3
    shadertoy_out_color st_assert mainCubemap
    """
)
SHADERTOY_MACROS: Final = frozenset({"HW_PERFORMANCE"})
# glslCanvas has at least 8 texture units; pictures of data-textures are numbered in order.
GLSL_CANVAS_NAMES: Final = _words(
    "u_resolution u_time u_delta u_date u_mouse u_frame a_position a_texcoord v_texcoord"
) | {f"{stem}{i}" for stem in ("u_tex", "u_buffer") for i in range(32)}
GLSL_CANVAS_MACROS: Final = frozenset({"PLATFORM_WEBGL"})
# VVISF-GL and interactive-shader-format-js. Both replace the parts even inside longer names.
ISF_NAMES: Final = _words(
    "PASSINDEX RENDERSIZE TIME TIMEDELTA FRAMEINDEX DATE VERTEXDATA position inputImage"
)
ISF_PREFIXES: Final = ("isf_", "vv_", "VVSAMPLER_", "VVISF_")
ISF_PARTS: Final = (
    *("IMG_PIXEL", "IMG_NORM_PIXEL", "IMG_THIS_PIXEL", "IMG_THIS_NORM_PIXEL", "IMG_SIZE"),
    *("vv_FragNormCoord", "vv_vertShaderInit"),
)


def isf_picture_names(picture: str) -> frozenset[str]:
    """Return the names that an ISF host declares in addition to a picture with this name."""
    stems = ("imgRect", "imgSize", "flip", "normTexCoord", "texCoord")
    return frozenset(f"_{picture}_{stem}" for stem in stems)
