"""Matrices by their columns, for targets that lack the operation."""

from __future__ import annotations

from distal.ir.limits import SMALLEST_DETERMINANT
from distal.lang import abs, cross, dot, func, mat2, mat3, mat4, select, transpose, vec2, vec3, vec4


@func
def transposed(m: mat2) -> mat2:
    """Rows become columns."""
    return mat2(vec2(m[0].x, m[1].x), vec2(m[0].y, m[1].y))


@transposed.overload
def transposed_3(m: mat3) -> mat3:
    """Rows become columns."""
    return mat3(
        vec3(m[0].x, m[1].x, m[2].x),
        vec3(m[0].y, m[1].y, m[2].y),
        vec3(m[0].z, m[1].z, m[2].z),
    )


@transposed.overload
def transposed_4(m: mat4) -> mat4:
    """Rows become columns."""
    return mat4(
        vec4(m[0].x, m[1].x, m[2].x, m[3].x),
        vec4(m[0].y, m[1].y, m[2].y, m[3].y),
        vec4(m[0].z, m[1].z, m[2].z, m[3].z),
        vec4(m[0].w, m[1].w, m[2].w, m[3].w),
    )


@func
def outer_product(a: vec2, b: vec2) -> mat2:
    """Column i is ``a * b[i]``."""
    return mat2(a * b.x, a * b.y)


@outer_product.overload
def outer_product_3(a: vec3, b: vec3) -> mat3:
    """Column i is ``a * b[i]``."""
    return mat3(a * b.x, a * b.y, a * b.z)


@outer_product.overload
def outer_product_4(a: vec4, b: vec4) -> mat4:
    """Column i is ``a * b[i]``."""
    return mat4(a * b.x, a * b.y, a * b.z, a * b.w)


@func
def cofactors_4(a: vec4, b: vec4, c: vec4) -> vec4:
    """The vector whose inner product with d is the determinant of the columns (d, a, b, c)."""
    # 2 x 2 minors of the last two columns, named by their rows.
    xy = b.x * c.y - b.y * c.x
    xz = b.x * c.z - b.z * c.x
    xw = b.x * c.w - b.w * c.x
    yz = b.y * c.z - b.z * c.y
    yw = b.y * c.w - b.w * c.y
    zw = b.z * c.w - b.w * c.z
    return vec4(
        a.y * zw - a.z * yw + a.w * yz,
        a.z * xw - a.x * zw - a.w * xz,
        a.x * yw - a.y * xw + a.w * xy,
        a.y * xz - a.x * yz - a.z * xy,
    )


@func
def determinant_of(m: mat2) -> float:
    """The signed area of the columns' parallelogram."""
    return m[0].x * m[1].y - m[1].x * m[0].y


@determinant_of.overload
def determinant_of_3(m: mat3) -> float:
    """The signed volume of the columns' parallelepiped."""
    return dot(m[0], cross(m[1], m[2]))


@determinant_of.overload
def determinant_of_4(m: mat4) -> float:
    """Laplace's expansion along the first column."""
    return dot(m[0], cofactors_4(m[1], m[2], m[3]))


@func
def inverse_factor(determinant: float) -> float:
    """1 / determinant; 0 for that of a singular matrix, which makes its inverse 0."""
    is_singular = abs(determinant) < SMALLEST_DETERMINANT
    return select(is_singular, 0.0, 1.0 / select(is_singular, 1.0, determinant))


@func
def inverse_of(m: mat2) -> mat2:
    """The adjugate over the determinant (Cramer's rule)."""
    adjugate = mat2(vec2(m[1].y, -m[0].y), vec2(-m[1].x, m[0].x))
    return adjugate * inverse_factor(determinant_of(m))


@inverse_of.overload
def inverse_of_3(m: mat3) -> mat3:
    """The adjugate over the determinant: its rows are the cross products of the columns."""
    first = cross(m[1], m[2])
    rows = mat3(first, cross(m[2], m[0]), cross(m[0], m[1]))
    return transpose(rows) * inverse_factor(dot(m[0], first))


@inverse_of.overload
def inverse_of_4(m: mat4) -> mat4:
    """The adjugate over the determinant; moving a column to the front may turn the sign."""
    first = cofactors_4(m[1], m[2], m[3])
    rows = mat4(
        first,
        -cofactors_4(m[0], m[2], m[3]),
        cofactors_4(m[0], m[1], m[3]),
        -cofactors_4(m[0], m[1], m[2]),
    )
    return transpose(rows) * inverse_factor(dot(m[0], first))
