/* Which program this is: "0.1.0+1a2b3c4", the version and the commit that was built ("*" behind it: with changes;
 * without git: the version alone). At most 15 bytes: `program_version` of state files. packaging/version.cmake writes
 * it. */
#ifndef PIPELINE_VERSION_H
#define PIPELINE_VERSION_H

extern const char film_version[];

#endif
