/*
 * relay.c - the least work a WebSocket publish/subscribe relay can do: the physical limit to hold a real
 * hub against, with the same load generator (wsload.c) on the same machine.
 *
 *   gcc -O2 -Wall -Wextra -o relay relay.c;  ./relay PORT [-c] [-s]        (port 0: any free one)
 *
 * NOT a hub: one topic for all, no JSON parser, no checks.  A text frame which has "subscribe" in its first
 * bytes makes the connection a subscriber; one which has "publish" is unmasked and its bytes go to all
 * subscribers; anything else is ignored.  One thread, epoll, 127.0.0.1 only.
 *   default  one write per publish per subscriber, straight away
 *   -c       coalesce: all publishes of one read go out in one write per subscriber
 *   -s       spend: walk over the payload once as a JSON scanner at least has to (byte loop)
 */
#define _GNU_SOURCE
#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#define RXCAP (1u << 20)
#define FRAME_MAX (32u << 20)
#define TXQ_MAX (64u << 20)          /* a subscriber further behind than this is dropped */

typedef struct { int fd; bool open, sub, want_out; int sub_pos; char *rx; size_t n, cap; char *tx; size_t off, len, tcap; } conn_t;
static conn_t *C[65536]; static int ep, subs[65536], nsubs; static bool coalesce, spend;
static char *batch; static size_t batch_len, batch_cap; static volatile unsigned sink;

/* SHA-1 and base64, for Sec-WebSocket-Accept */
static uint32_t rol(uint32_t v, int n) { return v << n | v >> (32 - n); }
static void sha1(const unsigned char *m, size_t n, unsigned char out[20]) {
    uint32_t h[5] = { 0x67452301, 0xEFCDAB89, 0x98BADCFE, 0x10325476, 0xC3D2E1F0 }; unsigned char b[128] = { 0 };
    size_t tot = n < 56 ? 64 : 128; if (n > 119) return;
    memcpy(b, m, n); b[n] = 0x80; uint64_t bits = (uint64_t)n * 8; for (int i = 0; i < 8; i++) b[tot - 1 - (size_t)i] = (unsigned char)(bits >> (8 * i));
    for (size_t o = 0; o < tot; o += 64) {
        uint32_t w[80]; for (int i = 0; i < 16; i++) w[i] = (uint32_t)b[o + 4 * (size_t)i] << 24 | (uint32_t)b[o + 4 * (size_t)i + 1] << 16 | (uint32_t)b[o + 4 * (size_t)i + 2] << 8 | b[o + 4 * (size_t)i + 3];
        for (int i = 16; i < 80; i++) w[i] = rol(w[i - 3] ^ w[i - 8] ^ w[i - 14] ^ w[i - 16], 1);
        uint32_t a = h[0], bb = h[1], c = h[2], d = h[3], e = h[4];
        for (int i = 0; i < 80; i++) {
            uint32_t f, k;
            if (i < 20) { f = (bb & c) | (~bb & d); k = 0x5A827999; } else if (i < 40) { f = bb ^ c ^ d; k = 0x6ED9EBA1; }
            else if (i < 60) { f = (bb & c) | (bb & d) | (c & d); k = 0x8F1BBCDC; } else { f = bb ^ c ^ d; k = 0xCA62C1D6; }
            uint32_t t = rol(a, 5) + f + e + k + w[i]; e = d; d = c; c = rol(bb, 30); bb = a; a = t;
        }
        h[0] += a; h[1] += bb; h[2] += c; h[3] += d; h[4] += e;
    }
    for (int i = 0; i < 5; i++) for (int j = 0; j < 4; j++) out[4 * i + j] = (unsigned char)(h[i] >> (24 - 8 * j));
}
static void b64(const unsigned char *in, char *o) {                 /* 20 bytes -> 28 characters */
    static const char a[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (int i = 0; i < 18; i += 3) { uint32_t v = (uint32_t)in[i] << 16 | (uint32_t)in[i + 1] << 8 | in[i + 2]; *o++ = a[v >> 18]; *o++ = a[v >> 12 & 63]; *o++ = a[v >> 6 & 63]; *o++ = a[v & 63]; }
    uint32_t v = (uint32_t)in[18] << 16 | (uint32_t)in[19] << 8; *o++ = a[v >> 18]; *o++ = a[v >> 12 & 63]; *o++ = a[v >> 6 & 63]; *o++ = '='; *o = 0;
}
static void drop(conn_t *c) {
    if (c->sub) { int last = subs[--nsubs]; subs[c->sub_pos] = last; C[last]->sub_pos = c->sub_pos; }
    C[c->fd] = NULL; close(c->fd); free(c->rx); free(c->tx); free(c);
}
static void set_out(conn_t *c, bool on) {
    if (c->want_out == on) return;
    c->want_out = on;
    struct epoll_event e = { .events = EPOLLIN | (on ? EPOLLOUT : 0), .data.fd = c->fd }; epoll_ctl(ep, EPOLL_CTL_MOD, c->fd, &e);
}
static bool flush_tx(conn_t *c) {
    while (c->off < c->len) {
        ssize_t n = send(c->fd, c->tx + c->off, c->len - c->off, MSG_NOSIGNAL | MSG_DONTWAIT);
        if (n > 0) c->off += (size_t)n; else if (n < 0 && errno == EINTR) continue; else if (n < 0 && errno == EAGAIN) { set_out(c, true); return true; } else return false;
    }
    c->off = c->len = 0; set_out(c, false); return true;
}
static bool put(conn_t *c, const char *p, size_t n) {
    if (c->off == c->len) {                                         /* nothing queued: straight to the socket */
        ssize_t k; do k = send(c->fd, p, n, MSG_NOSIGNAL | MSG_DONTWAIT); while (k < 0 && errno == EINTR);
        if (k == (ssize_t)n) return true;
        if (k < 0 && errno != EAGAIN) return false;
        if (k > 0) { p += k; n -= (size_t)k; }
    }
    if (c->off) { memmove(c->tx, c->tx + c->off, c->len - c->off); c->len -= c->off; c->off = 0; }
    if (c->len + n > c->tcap) { size_t cap = c->tcap ? c->tcap : 65536; while (cap < c->len + n) cap *= 2; if (cap > TXQ_MAX) return false; c->tx = realloc(c->tx, cap); if (!c->tx) abort(); c->tcap = cap; }
    memcpy(c->tx + c->len, p, n); c->len += n; set_out(c, true); return true;
}
static void to_all(const char *p, size_t n) { for (int i = nsubs - 1; i >= 0; i--) { conn_t *s = C[subs[i]]; if (!put(s, p, n)) shutdown(s->fd, SHUT_RDWR); } }

static void on_frame(conn_t *c, int op, char *b, size_t n, char *hdr_room) {
    if (op == 9) { if (n < 126) { char f[128]; f[0] = (char)0x8a; f[1] = (char)n; memcpy(f + 2, b, n); put(c, f, n + 2); } return; }
    if (op != 1) return;
    size_t head = n < 64 ? n : 64;
    if (memmem(b, head, "\"subscribe\"", 11)) { if (!c->sub) { c->sub = true; c->sub_pos = nsubs; subs[nsubs++] = c->fd; } return; }
    if (!memmem(b, head, "\"publish\"", 9)) return;
    if (spend) { unsigned h = 0; for (size_t i = 0; i < n; i++) { if (b[i] == '\\') i++; else if (b[i] == '"') h++; } sink += h; }
    char *h; (void)hdr_room;                                        /* a server header is never longer than the client's: build it in place */
    if (n < 126) { h = b - 2; h[1] = (char)n; } else if (n < 65536) { h = b - 4; h[1] = 126; h[2] = (char)(n >> 8); h[3] = (char)n; }
    else { h = b - 10; h[1] = 127; for (int i = 0; i < 8; i++) h[2 + i] = (char)((uint64_t)n >> (56 - 8 * i)); }
    h[0] = (char)0x81; size_t tot = (size_t)(b - h) + n;
    if (!coalesce) { to_all(h, tot); return; }
    if (batch_len + tot > batch_cap) { batch_cap = (batch_len + tot) * 2; batch = realloc(batch, batch_cap); if (!batch) abort(); }
    memcpy(batch + batch_len, h, tot); batch_len += tot;
}
static bool parse(conn_t *c) {
    size_t u = 0;
    if (!c->open) {
        char *e = memmem(c->rx, c->n, "\r\n\r\n", 4); if (!e) return c->n < 16384;
        *e = 0; char *k = strcasestr(c->rx, "\r\nSec-WebSocket-Key:"); if (!k) return false;
        k += 20; while (*k == ' ') k++;
        char in[128]; size_t kl = strcspn(k, "\r\n "); if (kl > 60) return false;
        int il = snprintf(in, sizeof in, "%.*s258EAFA5-E914-47DA-95CA-C5AB0DC85B11", (int)kl, k); unsigned char d[20]; sha1((unsigned char *)in, (size_t)il, d);
        char acc[32], r[256]; b64(d, acc); int rl = snprintf(r, sizeof r, "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: %s\r\n\r\n", acc);
        if (!put(c, r, (size_t)rl)) return false;
        c->open = true; u = (size_t)(e - c->rx) + 4;
    }
    while (c->n - u >= 6) {
        unsigned char *h = (unsigned char *)c->rx + u; size_t hl = 6, av = c->n - u; uint64_t len = h[1] & 127;
        if (!(h[1] & 0x80)) return false;
        if (len == 126) { if (av < 8) break; len = (uint64_t)h[2] << 8 | h[3]; hl = 8; } else if (len == 127) { if (av < 14) break; len = 0; for (int i = 0; i < 8; i++) len = len << 8 | h[2 + i]; hl = 14; }
        if (len > FRAME_MAX) return false;
        if (av < hl + len) break;
        char *b = (char *)h + hl; uint32_t k; memcpy(&k, b - 4, 4); uint64_t kk = (uint64_t)k << 32 | k; size_t i = 0;
        for (; i + 8 <= len; i += 8) { uint64_t v; memcpy(&v, b + i, 8); v ^= kk; memcpy(b + i, &v, 8); }
        for (; i < len; i++) b[i] ^= ((char *)&k)[i & 3];
        int op = h[0] & 15; if (op == 8) return false;
        on_frame(c, op, b, (size_t)len, b); u += hl + (size_t)len;
    }
    if (u) { memmove(c->rx, c->rx + u, c->n - u); c->n -= u; }
    if (batch_len) { to_all(batch, batch_len); batch_len = 0; }
    return true;
}
int main(int argc, char **argv) {
    int port = argc > 1 ? atoi(argv[1]) : 0; for (int i = 2; i < argc; i++) { if (!strcmp(argv[i], "-c")) coalesce = true; if (!strcmp(argv[i], "-s")) spend = true; }
    if (port < 0 || port > 65535 || argc < 2) { fprintf(stderr, "usage: relay PORT [-c] [-s]\n"); return 1; }
    signal(SIGPIPE, SIG_IGN); struct rlimit rl; if (!getrlimit(RLIMIT_NOFILE, &rl)) { rl.rlim_cur = rl.rlim_max; setrlimit(RLIMIT_NOFILE, &rl); }
    int ls = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK, 0), one = 1; setsockopt(ls, SOL_SOCKET, SO_REUSEADDR, &one, sizeof one);
    struct sockaddr_in a = { .sin_family = AF_INET, .sin_port = htons((uint16_t)port), .sin_addr.s_addr = htonl(INADDR_LOOPBACK) };
    if (bind(ls, (struct sockaddr *)&a, sizeof a) || listen(ls, 1024)) { perror("relay"); return 1; }
    socklen_t al = sizeof a; getsockname(ls, (struct sockaddr *)&a, &al);
    ep = epoll_create1(0); struct epoll_event e = { .events = EPOLLIN, .data.fd = ls }; epoll_ctl(ep, EPOLL_CTL_ADD, ls, &e);
    printf("relay on ws://127.0.0.1:%d pid %d%s%s\n", ntohs(a.sin_port), getpid(), coalesce ? " coalesce" : "", spend ? " spend" : ""); fflush(stdout);
    for (;;) {
        struct epoll_event ev[256]; int n = epoll_wait(ep, ev, 256, -1);
        for (int i = 0; i < n; i++) {
            int fd = ev[i].data.fd;
            if (fd == ls) {
                int s; while ((s = accept4(ls, NULL, NULL, SOCK_NONBLOCK)) >= 0) {
                    if (s >= 65536) { close(s); continue; }
                    setsockopt(s, IPPROTO_TCP, TCP_NODELAY, &one, sizeof one); conn_t *c = calloc(1, sizeof *c); if (!c) abort();
                    c->fd = s; C[s] = c; struct epoll_event x = { .events = EPOLLIN, .data.fd = s }; epoll_ctl(ep, EPOLL_CTL_ADD, s, &x);
                }
                continue;
            }
            conn_t *c = C[fd]; if (!c) continue;
            if (ev[i].events & EPOLLOUT) if (!flush_tx(c)) { drop(c); continue; }
            if (!(ev[i].events & (EPOLLIN | EPOLLHUP | EPOLLERR))) continue;
            if (c->cap - c->n < 4096) { c->cap = c->cap ? c->cap * 2 : 4096; if (c->cap > FRAME_MAX + RXCAP) { drop(c); continue; } c->rx = realloc(c->rx, c->cap); if (!c->rx) abort(); }
            ssize_t k = recv(fd, c->rx + c->n, c->cap - c->n - 1, 0);
            if (k < 0 && (errno == EAGAIN || errno == EINTR)) continue;
            if (k <= 0) { drop(c); continue; }
            c->n += (size_t)k; c->rx[c->n] = 0;
            if (!parse(c)) drop(c);
        }
    }
}
