/* Materials whose parameters are textures: the stage `material` has read these and left them as columns, by row of the
 * ray in `surface`; whoever makes a vertex copies them to the last columns of its table. Where nothing is textured, or
 * with READS_NO_SURFACE, of kernels that look textures up themselves or serve materials without, the macros here are
 * what they were without textures. */
#ifndef GRADUS_LIB_TEXTURED_MATERIAL_H
#define GRADUS_LIB_TEXTURED_MATERIAL_H
//! traits: TRAIT_MATERIAL TRAIT_TEXTURED TRAIT_TEXTURED_NORMALS TRAIT_BLENDS TRAIT_ANISOTROPIC TRAIT_SHADING_NORMALS
#include "kernels/lib/surface_point.h"
#include "kernels/shared/material.h"
#include "kernels/shared/tables.h"
#include "kernels/shared/texture.h"

#if TRAIT_MATERIAL && !READS_NO_SURFACE

GRADUS_LIB_BEGIN

#define IS_TEXTURED(name) HAS_PARAMETER(TRAIT_TEXTURED, name)

/* The columns: three for a colour, one for a number, none for what is not textured. */
#define GRADUS_COLOR_COLUMNS(with, name, value, text)                                                                  \
    textured_##name##_r, textured_##name##_g, textured_##name##_b,                                                     \
        textured_last_##name = textured_##name##_r + (IS_TEXTURED(name) ? 2 : -1),
#define GRADUS_NUMBER_COLUMN(with, name, value, text)                                                                  \
    textured_##name, textured_last_##name = textured_##name + (IS_TEXTURED(name) ? 0 : -1),
enum textured_column {
    GRADUS_TEXTURED_PARAMETERS(GRADUS_COLOR_COLUMNS, GRADUS_NUMBER_COLUMN, ) textured_parameter_columns
};
#undef GRADUS_COLOR_COLUMNS
#undef GRADUS_NUMBER_COLUMN

/* Then, only with TRAIT_TEXTURED_NORMALS, a mapped_normal: its vector, and its flags as a number. */
enum textured_normal_column {
    textured_normal_x = textured_parameter_columns,
    textured_normal_y,
    textured_normal_z,
    textured_normal_flags,
    textured_columns = textured_parameter_columns + (TRAIT_TEXTURED_NORMALS ? 4 : 0)
};

/* Columns of `surface` that follow; they are no part of tables of vertices. */
enum surface_column {
    surface_record = textured_columns,
    surface_columns = surface_record + (TRAIT_BLENDS > 0 ? 1 : 0)
};

#define GRADUS_TAKE_COLOR(with, name, value, text)                                                                     \
    if (IS_TEXTURED(name)) {                                                                                           \
        m.name##_r = columns[(size_t)textured_##name##_r * rows + row];                                                \
        m.name##_g = columns[(size_t)textured_##name##_g * rows + row];                                                \
        m.name##_b = columns[(size_t)textured_##name##_b * rows + row];                                                \
    }
#define GRADUS_TAKE_NUMBER(with, name, value, text)                                                                    \
    if (IS_TEXTURED(name))                                                                                             \
        m.name = columns[(size_t)textured_##name * rows + row];
/* The material with what its textures are worth in a row of columns. */
GRADUS_FN material material_with_textures(material m, GRADUS_GLOBAL const real *columns, size_t rows, size_t row) {
    GRADUS_TEXTURED_PARAMETERS(GRADUS_TAKE_COLOR, GRADUS_TAKE_NUMBER, )
    return m;
}
#undef GRADUS_TAKE_COLOR
#undef GRADUS_TAKE_NUMBER

/* The record that a blend has come to in a row of `surface`. */
GRADUS_FN uint surface_record_at(GRADUS_GLOBAL const real *surface, size_t rows, size_t row) {
    return *(GRADUS_GLOBAL const uint *)(surface + (size_t)surface_record * rows + row);
}

/* A hit as the stage `material` has it. */
GRADUS_FN surface_point surface_point_chosen(surface_point point, GRADUS_GLOBAL const real *surface, size_t rows,
                                             size_t row) {
    (void)surface, (void)rows, (void)row;
#if TRAIT_BLENDS
    point.material = surface_record_at(surface, rows, row);
#endif
    return point;
}

GRADUS_LIB_END

/* Where these columns begin in a table of vertices, after those that the scene has of GRADUS_SURFACE_VERTEX_COLUMNS. */
#define TEXTURED_PART(table)                                                                                           \
    ((table) + (size_t)(table##_columns - (TRAIT_ANISOTROPIC       ? 0                                                 \
                                           : TRAIT_SHADING_NORMALS ? 3                                                 \
                                                                   : 6)) *                                             \
                   (size_t)ROWS_OF_##table)

#define SURFACE_ARGUMENT , __global const real *surface
/* A surface_point with what `surface` says in a row of it, which has `rows` rows. */
#define CHOSEN_POINT(point, rows, row) surface_point_chosen(point, surface, rows, row)
/* The material of a ray's hit, from the record and row `row` of `surface`, which has `rows` rows. */
#define HIT_MATERIAL(record, rows, row)                                                                                \
    material_with_textures(material_load(materials, record, unit), surface, rows, row)
/* That of a row of a table of vertices. */
#define VERTEX_MATERIAL(table, row)                                                                                    \
    material_with_textures(material_load(materials, AT_UINT(table, material, row), unit), TEXTURED_PART(table),        \
                           ROWS_OF_##table, row)
/* Copies them to a row of a table of vertices. */
#define SET_VERTEX_TEXTURED(table, to_row, rows, row)                                                                  \
    _Pragma("unroll") for (uint c = 0; c < (uint)textured_columns; ++c)                                                \
        TEXTURED_PART(table)[(size_t)c * ROWS_OF_##table + (to_row)] = surface[(size_t)c * (rows) + (row)];

#else

#define SURFACE_ARGUMENT
#define CHOSEN_POINT(point, rows, row) point
#define HIT_MATERIAL(record, rows, row) material_load(materials, record, unit)
#define VERTEX_MATERIAL(table, row) material_load(materials, AT_UINT(table, material, row), unit)
#define SET_VERTEX_TEXTURED(table, to_row, rows, row)

#endif

#endif
