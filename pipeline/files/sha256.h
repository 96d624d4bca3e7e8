/* SHA-256 as 64 hexadecimal digits and a zero: how a file says which bytes it was made of. */
#ifndef PIPELINE_SHA256_H
#define PIPELINE_SHA256_H

/* Of a file, of what is left to read through a descriptor, of a text; -1 with an error. */
int file_sha256(const char *path, char digest[65]);
int descriptor_sha256(int fd, char digest[65]);
int text_sha256(const char *content, char digest[65]);

#endif
