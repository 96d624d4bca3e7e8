#include "contacts/find_contacts.h"
#include "pipeline/error.h"

int contact_options_read(const struct scene *scene, struct contact_options *options)
{
    static const char *const keys[] = {"radius_scale",     "radius_offset_px", "tolerance_px",
                                       "candidate_sigmas", "frame_error_px",   NULL};
    const struct json *json = scene->json;
    const cJSON *section = scene_section(scene, "contacts");
    if (!section)
        return 0;
    if (json_check_keys(json, section, keys) ||
        json_number(json, section, "radius_scale", 0.5, 2, &options->radius_scale) < 0 ||
        json_number(json, section, "radius_offset_px", -1000, 1000, &options->radius_offset_px) < 0 ||
        json_number(json, section, "tolerance_px", -1000, 1000, &options->tolerance_px) < 0 ||
        json_number(json, section, "candidate_sigmas", 0, 100, &options->candidate_sigmas) < 0 ||
        json_number(json, section, "frame_error_px", 0, 1000, &options->frame_error_px) < 0)
        return -1;
    return 0;
}
