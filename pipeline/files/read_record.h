/* Which bytes this process has read, so that a result can say so truly: a file may be replaced while a program works on
 * what it held before. A program that writes provenance begins the record first; from then on every input that is
 * opened (input_file_open, photo_read, state_open) is hashed through the descriptor that it is read through.
 *
 * What is not seen: bytes that are changed in place, between two clock ticks of the file system, without a change of
 * length. */
#ifndef PIPELINE_READ_RECORD_H
#define PIPELINE_READ_RECORD_H

/* From now on. Without it nothing is hashed on opening, and read_record_digest() looks at the file itself. */
void read_record_begin(void);

/* Note the regular file behind `fd`, known as `path`; the position in it is 0 afterwards. -1 with an error when it
 * cannot be read, or is not what was read under this name before. Nothing without a record. */
int read_record_note(const char *path, int fd);

/* SHA-256, 64 hexadecimal digits, of the bytes that were read under this name; of the file where none were. -1 with an
 * error (EXIT_INPUT) when the file that was read was changed in place since: the numbers may be of both. */
int read_record_digest(const char *path, char digest[65]);

#endif
