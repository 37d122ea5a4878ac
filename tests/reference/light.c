/* tests/reference/light.c - Phong's model with the lights of a picture.
 *
 * docs/model.md, sections 4 and V6. */
#include "reference/reference.h"

#include <math.h>

/* Degrees to the camera's right, then up. */
static void from_camera(const reference_camera *camera, double azimuth,
                        double elevation, double light[3]) {
    double a = azimuth * acos(-1.0) / 180, e = elevation * acos(-1.0) / 180;
    for (int n = 0; n < 3; n++)
        light[n] =
            cos(e) * (cos(a) * camera->back[n] + sin(a) * camera->right[n]) +
            sin(e) * camera->up[n];
}

/* Adds what one light gives to diffuse and specular light. */
static void add_light(const snow_settings *s, const double normal[3],
                      const double eye[3], const double light[3], double share,
                      double lit[2]) {
    double half[3], diffuse = reference_dot(normal, light);
    if (!(diffuse > 0))
        return;
    for (int n = 0; n < 3; n++)
        half[n] = light[n] + eye[n];
    double shine =
        fmax(0, reference_dot(normal, half) / sqrt(reference_dot(half, half)));
    lit[0] += share * s->diffuse * fmin(1, diffuse);
    lit[1] += share * s->specular * pow(fmin(1, shine), s->shininess);
}

void reference_light(const snow_settings *s, const reference_camera *camera,
                     const double normal[3], const double eye[3],
                     double lit[2]) {
    double length = sqrt(reference_dot(normal, normal)), n[3], light[3];
    bool angles = s->light_azimuth != 0 || s->light_elevation != 0;
    bool key =
        s->light == SNOW_LIGHT_KEY || (s->light == SNOW_LIGHT_AUTO && !angles);
    lit[0] = s->ambient;
    lit[1] = 0;
    if (!(length > 0))
        return;
    for (int c = 0; c < 3; c++)
        n[c] = (reference_dot(normal, eye) < 0 ? -1 : 1) * normal[c] / length;
    if (key) {
        from_camera(camera, -25, 35, light);
        add_light(s, n, eye, light, 0.65, lit);
        add_light(s, n, eye, eye, 0.35, lit);
    } else if (s->light == SNOW_LIGHT_HEAD || !angles) {
        add_light(s, n, eye, eye, 1, lit);
    } else {
        from_camera(camera, s->light_azimuth, s->light_elevation, light);
        add_light(s, n, eye, light, 1, lit);
    }
}
