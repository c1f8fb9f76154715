"""Matrix operations, computed from columns, for targets that lack them."""

from __future__ import annotations

from distal.ir.limits import SMALLEST_DETERMINANT
from distal.lang import abs, cross, dot, func, mat2, mat3, mat4, select, transpose, vec2, vec3, vec4


@func
def transposed(m: mat2) -> mat2:
    """Return the transposed matrix."""
    return mat2(vec2(m[0].x, m[1].x), vec2(m[0].y, m[1].y))


@transposed.overload
def transposed_3(m: mat3) -> mat3:
    """Return the transposed matrix."""
    return mat3(
        vec3(m[0].x, m[1].x, m[2].x),
        vec3(m[0].y, m[1].y, m[2].y),
        vec3(m[0].z, m[1].z, m[2].z),
    )


@transposed.overload
def transposed_4(m: mat4) -> mat4:
    """Return the transposed matrix."""
    return mat4(
        vec4(m[0].x, m[1].x, m[2].x, m[3].x),
        vec4(m[0].y, m[1].y, m[2].y, m[3].y),
        vec4(m[0].z, m[1].z, m[2].z, m[3].z),
        vec4(m[0].w, m[1].w, m[2].w, m[3].w),
    )


@func
def outer_product(a: vec2, b: vec2) -> mat2:
    """Return the matrix whose column i is ``a * b[i]``."""
    return mat2(a * b.x, a * b.y)


@outer_product.overload
def outer_product_3(a: vec3, b: vec3) -> mat3:
    """Return the matrix whose column i is ``a * b[i]``."""
    return mat3(a * b.x, a * b.y, a * b.z)


@outer_product.overload
def outer_product_4(a: vec4, b: vec4) -> mat4:
    """Return the matrix whose column i is ``a * b[i]``."""
    return mat4(a * b.x, a * b.y, a * b.z, a * b.w)


@func
def cofactors_4(a: vec4, b: vec4, c: vec4) -> vec4:
    """Return the vector whose dot product with d is the determinant of columns (d, a, b, c)."""
    # 2 x 2 minors of the last two columns; the names are their rows.
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
    """Return the signed area of the parallelogram of the columns."""
    return m[0].x * m[1].y - m[1].x * m[0].y


@determinant_of.overload
def determinant_of_3(m: mat3) -> float:
    """Return the signed volume of the parallelepiped of the columns."""
    return dot(m[0], cross(m[1], m[2]))


@determinant_of.overload
def determinant_of_4(m: mat4) -> float:
    """Return the determinant by Laplace expansion along the first column."""
    return dot(m[0], cofactors_4(m[1], m[2], m[3]))


@func
def inverse_factor(determinant: float) -> float:
    """Return 1 / determinant; 0 for a singular matrix, so that its inverse is 0."""
    is_singular = abs(determinant) < SMALLEST_DETERMINANT
    return select(is_singular, 0.0, 1.0 / select(is_singular, 1.0, determinant))


@func
def inverse_of(m: mat2) -> mat2:
    """Return the adjugate divided by the determinant (Cramer's rule)."""
    adjugate = mat2(vec2(m[1].y, -m[0].y), vec2(-m[1].x, m[0].x))
    return adjugate * inverse_factor(determinant_of(m))


@inverse_of.overload
def inverse_of_3(m: mat3) -> mat3:
    """Return the adjugate, whose rows are cross products of columns, divided by the determinant."""
    first = cross(m[1], m[2])
    rows = mat3(first, cross(m[2], m[0]), cross(m[0], m[1]))
    return transpose(rows) * inverse_factor(dot(m[0], first))


@inverse_of.overload
def inverse_of_4(m: mat4) -> mat4:
    """Return the adjugate divided by the determinant; two rows get a sign for the column order."""
    first = cofactors_4(m[1], m[2], m[3])
    rows = mat4(
        first,
        -cofactors_4(m[0], m[2], m[3]),
        cofactors_4(m[0], m[1], m[3]),
        -cofactors_4(m[0], m[1], m[2]),
    )
    return transpose(rows) * inverse_factor(dot(m[0], first))
