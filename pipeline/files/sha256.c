#include "pipeline/files/sha256.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <openssl/evp.h>

#include "pipeline/speak/error.h"
#include "pipeline/files/regular_file.h"

static int digest_stream(int fd, EVP_MD_CTX *context, unsigned char digest[32])
{
    unsigned char block[1 << 16];
    ssize_t length;
    if (!context || !EVP_DigestInit_ex(context, EVP_sha256(), NULL))
        return error_memory("SHA-256");
    while ((length = read(fd, block, sizeof block)) > 0 || (length < 0 && errno == EINTR))
        if (length > 0 && !EVP_DigestUpdate(context, block, (size_t)length))
            return error_failed("SHA-256 failed");
    if (length < 0)
        return error_input("cannot be read: %s: check the file", strerror(errno));
    return EVP_DigestFinal_ex(context, digest, NULL) ? 0 : error_failed("SHA-256 failed");
}

static void print_digest(const unsigned char digest[32], char text[65])
{
    for (int k = 0; k < 32; k++)
        snprintf(text + 2 * k, 3, "%02x", digest[k]);
}

int text_sha256(const char *content, char text[65])
{
    unsigned char digest[32];
    if (!EVP_Digest(content, strlen(content), digest, NULL, EVP_sha256(), NULL))
        return error_failed("SHA-256 failed");
    print_digest(digest, text);
    return 0;
}

int descriptor_sha256(int fd, char text[65])
{
    unsigned char digest[32] = {0};
    EVP_MD_CTX *context = EVP_MD_CTX_new();
    int failed = digest_stream(fd, context, digest);
    EVP_MD_CTX_free(context);
    if (!failed)
        print_digest(digest, text);
    return failed;
}

int file_sha256(const char *path, char text[65])
{
    int fd = regular_file(path, 0);
    if (fd < 0)
        return -1;
    int failed = descriptor_sha256(fd, text);
    close(fd);
    return failed ? error_context("%s", path) : 0;
}
