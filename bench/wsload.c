/*
 * wsload.c - load generator for servers that speak the rosbridge v2 protocol over WebSocket.
 *
 *   gcc -O2 -Wall -Wextra -o wsload wsload.c
 *
 * One file, one thread, epoll, no dependency.  Talks to 127.0.0.1 only.  Bounded in connections,
 * messages and time (see the LIMIT_* constants; a watchdog ends the process).
 *
 * It opens N subscriber connections and P publisher connections, makes sure (with probe messages)
 * that every publisher reaches every subscriber, and then does one of:
 *
 *   --rate R     open loop: R messages/s altogether for --dur seconds; one-way latency percentiles
 *   --window W   closed loop: at most W messages in flight, counted at the slowest subscriber
 *                (or at the first, with --window-at first): the most a server sustains with no loss;
 *                with --window-at none nothing is counted: a flood, held back by TCP alone
 *   --idle N     opens N subscribed connections, holds them for --hold s: connect rate, RSS per connection
 *
 * Each payload carries "T=<ns of CLOCK_MONOTONIC>;" and "S=<sequence>;".  Any text (or binary) frame of
 * the server's which has an op "publish" (whatever the key order and spacing) and that marker counts as a
 * delivery.  No permessage-deflate is offered.  The result is one line of JSON on stdout.
 *
 * Exit: 0 no loss, 3 loss, duplicates or lost connections, 2 could not set up, 1 usage.
 */
#define _GNU_SOURCE
#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <getopt.h>
#include <inttypes.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#define LIMIT_CONNS    20000
#define LIMIT_PUBS     64
#define LIMIT_WINDOW   65536
#define LIMIT_DUR_S    600.0
#define LIMIT_MSGS     100000000ULL
#define LIMIT_SIZE     (16u << 20)
#define LIMIT_TXQ      (256u << 20)   /* unsent bytes held back for one publisher */
#define LIMIT_FRAME    (64u << 20)
#define MAX_PIDS       8
#define SCRATCH        (256u << 10)

/* ------------------------------------------------------------------ options */
static int      o_port = 9090;
static const char *o_path = "/", *o_topic = "/wsload", *o_type = "std_msgs/String";
static const char *o_sub_extra = "", *o_pub_extra = "", *o_label = "";
static const char *o_msg = "{\"data\":\"%P\"}";
static const char *o_header = "";
static int      o_subs = 1, o_pubs = 1, o_idle = -1, o_inflight = 16;
static unsigned o_size = 32;
static double   o_rate = 0, o_dur = 5, o_warm = 1, o_hold = 3, o_drain = 10, o_setup = 60;
static int      o_window = 0;
static bool     o_window_first = false, o_window_none = false, o_no_type = false, o_no_advertise = false, o_verbose = false, o_idle_nosub = false;
static uint64_t o_count = 0;
static int      o_pids[MAX_PIDS], o_npids = 0;

/* ------------------------------------------------------------------ state */
enum { ST_NEW, ST_CONNECTING, ST_HANDSHAKE, ST_OPEN, ST_DEAD };
typedef struct {
    int      fd, idx;
    uint8_t  state, is_pub, frag_op, want_out;
    char    *rx;   size_t rxlen, rxcap;            /* an incomplete frame */
    char    *tx;   size_t txoff, txlen, txcap;     /* not yet written */
    char    *frag; size_t fraglen, fragcap;        /* an incomplete fragmented message */
    uint64_t t_start, recv, probes, *next_seq;     /* the sequence number due from each publisher */
} conn_t;

static conn_t  *C;                  /* subscribers first, then publishers */
static int      ncon, ep;
static char     scratch[SCRATCH + 16];
static uint64_t rng = 0x9E3779B97F4A7C15ULL;

static uint64_t rx_bytes, tx_bytes, total_recv, total_sent, pings, closes, conn_errors, other_frames, masked_frames, out_of_order, binary_frames;
static uint64_t min_recv, last_delivery_ns, last_probe_ns;
static int      opening, n_open;
static bool     measuring, record_lat;
static char     first_other[400], first_error[200];
static uint32_t *ring; static uint32_t ring_mask;   /* how many subscribers have had message number i */

/* the publish frame: JSON with holes for the timestamp and the sequence number */
static char    *tmpl; static size_t tmpl_len; static size_t t_off, s_off; static bool has_seq;
static char    *probe_tmpl; static size_t probe_len, probe_off;

static uint64_t now_ns(void) { struct timespec t; clock_gettime(CLOCK_MONOTONIC, &t); return (uint64_t)t.tv_sec * 1000000000ULL + (uint64_t)t.tv_nsec; }
static uint32_t rnd32(void) { rng ^= rng << 13; rng ^= rng >> 7; rng ^= rng << 17; return (uint32_t)(rng >> 16); }
static void die(const char *fmt, ...) { va_list a; va_start(a, fmt); fprintf(stderr, "wsload: "); vfprintf(stderr, fmt, a); fprintf(stderr, "\n"); va_end(a); exit(2); }
static void *xrealloc(void *p, size_t n) { void *q = realloc(p, n); if (!q) die("out of memory"); return q; }
static void note_error(const char *fmt, ...) { conn_errors++; if (first_error[0]) return; va_list a; va_start(a, fmt); vsnprintf(first_error, sizeof first_error, fmt, a); va_end(a); if (o_verbose) fprintf(stderr, "wsload: %s\n", first_error); }

/* ------------------------------------------------------------------ latency histogram: 1/256 relative resolution */
#define HSUB 256
static uint64_t hist[64 * HSUB], hist_n, hist_max, hist_min = UINT64_MAX; static double hist_sum;
static void hist_add(uint64_t ns) {
    int e = ns < HSUB ? 0 : 63 - __builtin_clzll(ns) - 7;          /* ns >> e lies in [HSUB/2, HSUB) for e > 0 */
    hist[(size_t)e * HSUB + (size_t)(ns >> e)]++;
    hist_n++; hist_sum += (double)ns;
    if (ns > hist_max) hist_max = ns;
    if (ns < hist_min) hist_min = ns;
}
static double hist_pct(double p) {                                  /* microseconds */
    if (!hist_n) return 0;
    uint64_t want = (uint64_t)(p / 100.0 * (double)hist_n + 0.5), c = 0;
    if (want < 1) want = 1;
    if (want > hist_n) want = hist_n;
    for (int e = 0; e < 57; e++) for (int s = 0; s < HSUB; s++) {
        c += hist[e * HSUB + s];
        if (c >= want) { uint64_t v = (((uint64_t)s << e) + (((uint64_t)s + 1) << e)) / 2; if (v > hist_max) v = hist_max; return (double)v / 1000.0; }
    }
    return (double)hist_max / 1000.0;
}

/* ------------------------------------------------------------------ the server's processes */
typedef struct { double cpu_us, rss_mb, self_us; long threads; uint64_t t, recv, sent, rxb; } sample_t;
/* How fast is this machine just now?  CPU time of a fixed loop: other load on the sibling of our core makes every
 * cpu_us figure larger by the same factor, and this shows it. */
static double calibrate(void) {
    struct timespec a, b; volatile uint32_t sink; uint32_t x = 2463534242u;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &a);
    for (int i = 0; i < 5000000; i++) { x ^= x << 13; x ^= x >> 17; x ^= x << 5; }
    sink = x; (void)sink; clock_gettime(CLOCK_THREAD_CPUTIME_ID, &b);
    return ((double)(b.tv_sec - a.tv_sec) * 1e9 + (double)(b.tv_nsec - a.tv_nsec)) / 1e6;
}
static double calib_ms[2];
static sample_t take_sample(void) {
    sample_t s; memset(&s, 0, sizeof s);
    double tick = 1e6 / (double)sysconf(_SC_CLK_TCK), page = (double)sysconf(_SC_PAGESIZE) / 1048576.0;
    for (int i = 0; i < o_npids; i++) {
        char p[64], b[1024]; snprintf(p, sizeof p, "/proc/%d/stat", o_pids[i]);
        FILE *f = fopen(p, "r"); if (!f) { note_error("no process %d", o_pids[i]); continue; }
        size_t n = fread(b, 1, sizeof b - 1, f); fclose(f); b[n] = 0;
        char *q = strrchr(b, ')'); if (!q) continue;
        unsigned long ut = 0, st = 0; long thr = 0, rss = 0;
        if (sscanf(q + 2, "%*c %*d %*d %*d %*d %*d %*u %*u %*u %*u %*u %lu %lu %*d %*d %*d %*d %ld %*d %*u %*u %ld", &ut, &st, &thr, &rss) == 4) {
            clockid_t ck; struct timespec ts;                        /* the process's CPU clock has ns, stat only ticks; same sum */
            if (!clock_getcpuclockid(o_pids[i], &ck) && !clock_gettime(ck, &ts)) s.cpu_us += (double)ts.tv_sec * 1e6 + (double)ts.tv_nsec / 1e3;
            else s.cpu_us += (double)(ut + st) * tick;
            s.threads += thr; s.rss_mb += (double)rss * page;
        }
    }
    struct rusage ru; getrusage(RUSAGE_SELF, &ru);
    s.self_us = (double)ru.ru_utime.tv_sec * 1e6 + (double)ru.ru_utime.tv_usec + (double)ru.ru_stime.tv_sec * 1e6 + (double)ru.ru_stime.tv_usec;
    s.t = now_ns(); s.recv = total_recv; s.sent = total_sent; s.rxb = rx_bytes;
    return s;
}

/* ------------------------------------------------------------------ writing */
static void set_out(conn_t *c, bool on) {
    if (c->want_out == on) return;
    c->want_out = on;
    struct epoll_event e = { .events = EPOLLIN | (on ? EPOLLOUT : 0), .data.u32 = (uint32_t)c->idx };
    epoll_ctl(ep, EPOLL_CTL_MOD, c->fd, &e);
}
static void drop(conn_t *c) {
    if (c->state == ST_DEAD) return;
    if (c->state != ST_OPEN) opening--; else n_open--;
    c->state = ST_DEAD; epoll_ctl(ep, EPOLL_CTL_DEL, c->fd, NULL); close(c->fd); c->fd = -1;
}
static void flush_tx(conn_t *c) {
    while (c->txoff < c->txlen) {
        ssize_t n = send(c->fd, c->tx + c->txoff, c->txlen - c->txoff, MSG_NOSIGNAL);
        if (n > 0) { c->txoff += (size_t)n; tx_bytes += (uint64_t)n; continue; }
        if (n < 0 && errno == EINTR) continue;
        if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) { set_out(c, true); return; }
        note_error("write on connection %d: %s", c->idx, strerror(errno)); drop(c); return;
    }
    c->txoff = c->txlen = 0; set_out(c, false);
}
static char *tx_room(conn_t *c, size_t n) {
    if (c->txoff && c->txoff == c->txlen) c->txoff = c->txlen = 0;
    if (c->txlen + n > c->txcap && c->txoff) { memmove(c->tx, c->tx + c->txoff, c->txlen - c->txoff); c->txlen -= c->txoff; c->txoff = 0; }
    if (c->txlen + n > c->txcap) {
        size_t cap = c->txcap ? c->txcap : 4096; while (cap < c->txlen + n) cap *= 2;
        if (cap > LIMIT_TXQ) die("the server does not take our data: over %u bytes unsent", LIMIT_TXQ);
        c->tx = xrealloc(c->tx, cap); c->txcap = cap;
    }
    return c->tx + c->txlen;
}
static void put_raw(conn_t *c, const char *s, size_t n) { memcpy(tx_room(c, n), s, n); c->txlen += n; if (!c->want_out) flush_tx(c); }

static void put_frame(conn_t *c, int op, const char *body, size_t n) {       /* a masked client frame */
    if (c->state == ST_DEAD) return;
    char *p = tx_room(c, n + 14 + 8), *h = p;
    *p++ = (char)(0x80 | op);
    if (n < 126) *p++ = (char)(0x80 | n);
    else if (n < 65536) { *p++ = (char)(0x80 | 126); *p++ = (char)(n >> 8); *p++ = (char)n; }
    else { *p++ = (char)(0x80 | 127); for (int i = 7; i >= 0; i--) *p++ = (char)((uint64_t)n >> (8 * i)); }
    uint32_t k = rnd32(); memcpy(p, &k, 4); p += 4;
    uint64_t kk = (uint64_t)k << 32 | k; size_t i = 0;
    for (; i + 8 <= n; i += 8) { uint64_t v; memcpy(&v, body + i, 8); v ^= kk; memcpy(p + i, &v, 8); }
    for (; i < n; i++) p[i] = body[i] ^ ((char *)&k)[i & 3];
    c->txlen += (size_t)(p - h) + n;
    if (!c->want_out) flush_tx(c);
}
static void put_json(conn_t *c, const char *fmt, ...) {
    char b[4096]; va_list a; va_start(a, fmt); int n = vsnprintf(b, sizeof b, fmt, a); va_end(a);
    if (n >= (int)sizeof b) die("operation too long");
    put_frame(c, 1, b, (size_t)n);
}
static void send_publish(conn_t *c) {
    char d[24]; snprintf(d, sizeof d, "%019" PRIu64, now_ns()); memcpy(tmpl + t_off, d, 19);
    if (has_seq) { snprintf(d, sizeof d, "%07u", (unsigned)(total_sent % 10000000)); memcpy(tmpl + s_off, d, 7); }
    total_sent++;
    put_frame(c, 1, tmpl, tmpl_len);
}
static void send_probe(conn_t *c, int pub) {
    probe_tmpl[probe_off] = (char)('0' + pub / 10); probe_tmpl[probe_off + 1] = (char)('0' + pub % 10);
    put_frame(c, 1, probe_tmpl, probe_len);
}

/* ------------------------------------------------------------------ reading */
static bool has_op_publish(const char *p, size_t n) {
    return memmem(p, n, "\"op\":\"publish\"", 14) || memmem(p, n, "\"op\": \"publish\"", 15);
}
static const char *find2(const char *p, size_t n, const char *m) {           /* "T=" and digits and ';' */
    const char *e = p + n;
    while ((p = memmem(p, (size_t)(e - p), m, 2))) {
        const char *q = p + 2; while (q < e && *q >= '0' && *q <= '9') q++;
        if (q > p + 2 && q < e && *q == ';') return p + 2;
        p += 2;
    }
    return NULL;
}
static void on_message(conn_t *c, int op, const char *p, size_t n, uint64_t t) {
    size_t head = n < 512 ? n : 512;
    bool pub = op == 2 || has_op_publish(p, head) || (n > head && has_op_publish(p, n));
    if (op == 2) binary_frames++;
    const char *m = NULL;
    if (pub) { m = find2(p, head, "T="); if (!m && n > head) m = find2(p, n, "T="); }
    if (pub && m && !c->is_pub) {
        uint64_t ts = strtoull(m, NULL, 10);
        c->recv++; total_recv++; last_delivery_ns = t;
        if (record_lat) hist_add(t > ts ? t - ts : 0);
        if (c->next_seq) {
            const char *s = find2(m, (size_t)(p + n - m), "S=");
            if (s) { uint64_t q = strtoull(s, NULL, 10), *due = &c->next_seq[q % (uint64_t)o_pubs]; if (q != *due) out_of_order++; *due = (q + (uint64_t)o_pubs) % 10000000; }
        }
        if (ring) {
            if (!o_window_first) { uint32_t k = (uint32_t)c->recv & ring_mask; if (++ring[k] == (uint32_t)o_subs) { ring[k] = 0; min_recv = c->recv; } }
            else if (c->idx == 0) min_recv = c->recv;
        }
        return;
    }
    if (pub && !c->is_pub) { m = find2(p, n, "W="); if (m) { unsigned long k = strtoul(m, NULL, 10); if (k < 64) c->probes |= 1ULL << k; last_probe_ns = t; return; } }
    other_frames++;
    if (!first_other[0]) { size_t k = n < sizeof first_other - 1 ? n : sizeof first_other - 1; memcpy(first_other, p, k); first_other[k] = 0; }
    if (o_verbose) fprintf(stderr, "wsload: <%d %.*s\n", c->idx, (int)(n < 300 ? n : 300), p);
}
static void on_open(conn_t *c) {
    c->state = ST_OPEN; opening--; n_open++;
    if (o_idle >= 0 && o_idle_nosub) return;
    if (c->is_pub) { if (!o_no_advertise) put_json(c, "{\"op\":\"advertise\",\"topic\":\"%s\",\"type\":\"%s\"%s%s}", o_topic, o_type, o_pub_extra[0] ? "," : "", o_pub_extra); }
    else if (o_no_type) put_json(c, "{\"op\":\"subscribe\",\"topic\":\"%s\"%s%s}", o_topic, o_sub_extra[0] ? "," : "", o_sub_extra);
    else put_json(c, "{\"op\":\"subscribe\",\"topic\":\"%s\",\"type\":\"%s\"%s%s}", o_topic, o_type, o_sub_extra[0] ? "," : "", o_sub_extra);
}
/* takes whole frames from p[0..n), returns how many bytes it used */
static size_t parse(conn_t *c, char *p, size_t n, uint64_t t) {
    size_t used = 0;
    if (c->state == ST_HANDSHAKE) {
        char *e = memmem(p, n, "\r\n\r\n", 4);
        if (!e) { if (n > 65536) { note_error("handshake answer too long"); drop(c); return n; } return 0; }
        if (n < 12 || memcmp(p + 8, " 101", 4)) { note_error("handshake refused: %.*s", (int)(n < 60 ? n : 60), p); drop(c); return n; }
        used = (size_t)(e - p) + 4; on_open(c);
    }
    while (c->state == ST_OPEN && n - used >= 2) {
        unsigned char *h = (unsigned char *)p + used; size_t hl = 2, avail = n - used; uint64_t len = h[1] & 0x7f;
        bool masked = h[1] & 0x80, fin = h[0] & 0x80; int op = h[0] & 0x0f;
        if (len == 126) { if (avail < 4) break; len = (uint64_t)h[2] << 8 | h[3]; hl = 4; }
        else if (len == 127) { if (avail < 10) break; len = 0; for (int i = 0; i < 8; i++) len = len << 8 | h[2 + i]; hl = 10; }
        if (masked) { masked_frames++; hl += 4; }
        if (len > LIMIT_FRAME) { note_error("frame of %" PRIu64 " bytes", len); drop(c); return n; }
        if (avail < hl + len) break;
        char *b = (char *)h + hl;
        if (masked) for (uint64_t i = 0; i < len; i++) b[i] ^= b[-4 + (int)(i & 3)];
        if (h[0] & 0x70) { note_error("reserved bits set: the server compresses although it was not offered"); drop(c); return n; }
        if (op == 9) { pings++; put_frame(c, 10, b, (size_t)len); }
        else if (op == 10) { }
        else if (op == 8) { closes++; note_error("server closed connection %d, code %d", c->idx, len >= 2 ? (unsigned char)b[0] << 8 | (unsigned char)b[1] : 0); put_frame(c, 8, b, len > 2 ? 2 : (size_t)len); drop(c); return n; }
        else if (op == 0 || !fin) {
            if (op) { c->frag_op = (uint8_t)op; c->fraglen = 0; }
            if (c->fraglen + len > LIMIT_FRAME) { note_error("fragmented message too long"); drop(c); return n; }
            if (c->fraglen + len > c->fragcap) { c->fragcap = (c->fraglen + len) * 2; c->frag = xrealloc(c->frag, c->fragcap); }
            memcpy(c->frag + c->fraglen, b, len); c->fraglen += len;
            if (fin) on_message(c, c->frag_op, c->frag, c->fraglen, t);
        } else on_message(c, op, b, (size_t)len, t);
        used += hl + (size_t)len;
    }
    return used;
}
static void on_readable(conn_t *c) {
    char *buf; size_t have, cap;
    if (c->rxlen == 0) { buf = scratch; have = 0; cap = SCRATCH; }
    else {
        if (c->rxlen + 65536 > c->rxcap) { c->rxcap = (c->rxlen + 65536) * 2; c->rx = xrealloc(c->rx, c->rxcap); }
        buf = c->rx; have = c->rxlen; cap = c->rxcap;
    }
    ssize_t n = recv(c->fd, buf + have, cap - have, 0);
    if (n < 0 && (errno == EAGAIN || errno == EINTR)) return;
    if (n <= 0) { note_error("connection %d lost: %s", c->idx, n ? strerror(errno) : "end of file"); drop(c); return; }
    rx_bytes += (uint64_t)n; have += (size_t)n;
    size_t used = parse(c, buf, have, now_ns());
    if (c->state == ST_DEAD) return;
    size_t rest = have - used;
    if (buf == scratch) {
        if (rest) { if (rest + 65536 > c->rxcap) { c->rxcap = rest + 65536; c->rx = xrealloc(c->rx, c->rxcap); } memcpy(c->rx, scratch + used, rest); }
    } else if (used && rest) memmove(c->rx, c->rx + used, rest);
    c->rxlen = rest;
    if (!rest && c->rxcap > 131072 && o_subs > 64) { free(c->rx); c->rx = NULL; c->rxcap = 0; }
}

/* ------------------------------------------------------------------ connecting */
static void start_connect(conn_t *c) {
    c->fd = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (c->fd < 0) die("socket: %s (RLIMIT_NOFILE?)", strerror(errno));
    int one = 1; setsockopt(c->fd, IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
    struct sockaddr_in a = { .sin_family = AF_INET, .sin_port = htons((uint16_t)o_port), .sin_addr.s_addr = htonl(INADDR_LOOPBACK) };
    c->t_start = now_ns(); c->state = ST_CONNECTING; opening++;
    if (connect(c->fd, (struct sockaddr *)&a, sizeof a) < 0 && errno != EINPROGRESS) die("connect to 127.0.0.1:%d: %s", o_port, strerror(errno));
    struct epoll_event e = { .events = EPOLLIN | EPOLLOUT, .data.u32 = (uint32_t)c->idx }; c->want_out = 1;
    if (epoll_ctl(ep, EPOLL_CTL_ADD, c->fd, &e)) die("epoll_ctl: %s", strerror(errno));
}
static void on_writable(conn_t *c) {
    if (c->state == ST_CONNECTING) {
        int err = 0; socklen_t l = sizeof err; getsockopt(c->fd, SOL_SOCKET, SO_ERROR, &err, &l);
        if (err) { note_error("connect: %s", strerror(err)); drop(c); return; }
        static const char b64[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        char key[25]; for (int i = 0; i < 21; i++) key[i] = b64[rnd32() & 63];
        key[21] = "AQgw"[rnd32() & 3]; key[22] = key[23] = '='; key[24] = 0;
        char r[2048]; int n = snprintf(r, sizeof r, "GET %s HTTP/1.1\r\nHost: 127.0.0.1:%d\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            "Sec-WebSocket-Key: %s\r\nSec-WebSocket-Version: 13\r\n%s%s\r\n", o_path, o_port, key, o_header, o_header[0] ? "\r\n" : "");
        if (n >= (int)sizeof r) die("request too long");
        c->state = ST_HANDSHAKE; set_out(c, false); put_raw(c, r, (size_t)n); return;
    }
    flush_tx(c);
}
static void pump(int64_t timeout_ns) {          /* one round of events */
    struct epoll_event ev[512]; struct timespec ts = { 0, 0 };
    if (timeout_ns > 0) { ts.tv_sec = timeout_ns / 1000000000; ts.tv_nsec = timeout_ns % 1000000000; }
    int n = epoll_pwait2(ep, ev, 512, &ts, NULL);
    if (n < 0) { if (errno == EINTR) return; die("epoll: %s", strerror(errno)); }
    for (int i = 0; i < n; i++) {
        conn_t *c = &C[ev[i].data.u32];
        if (c->state == ST_DEAD) continue;
        if (ev[i].events & (EPOLLIN | EPOLLHUP | EPOLLERR)) { if (c->state == ST_CONNECTING) on_writable(c); else on_readable(c); }
        if (c->state != ST_DEAD && (ev[i].events & EPOLLOUT) && c->want_out) on_writable(c);
    }
}
static double open_all(void) {                  /* seconds for all connections */
    uint64_t t0 = now_ns(), end = t0 + (uint64_t)(o_setup * 1e9); int next = 0;
    while (n_open < ncon) {
        while (next < ncon && opening < o_inflight) start_connect(&C[next++]);
        pump(20000000);
        if (conn_errors) die("setup: %s (%d of %d open)", first_error, n_open, ncon);
        if (now_ns() > end) die("setup: %d of %d connections after %.0f s", n_open, ncon, o_setup);
    }
    return (double)(now_ns() - t0) / 1e9;
}

/* ------------------------------------------------------------------ output */
static void json_str(const char *k, const char *s) {
    printf("\"%s\": \"", k);
    for (; *s; s++) { unsigned char ch = (unsigned char)*s; if (ch == '"' || ch == '\\') printf("\\%c", ch); else if (ch < 0x20 || ch > 0x7e) printf("\\u%04x", ch); else putchar(ch); }
    printf("\"");
}
static void print_tail(double connect_s, const sample_t *a, const sample_t *b) {
    double dt = (double)(b->t - a->t) / 1e9;
    calib_ms[1] = calibrate();
    printf(", \"calib_ms\": [%.2f, %.2f]", calib_ms[0], calib_ms[1]);
    printf(", \"connect_s\": %.4f, \"connects_per_s\": %.1f", connect_s, connect_s > 0 ? ncon / connect_s : 0);
    printf(", \"server_rss_mb\": %.1f, \"server_threads\": %ld, \"server_cpu_percent\": %.1f", b->rss_mb, b->threads, dt > 0 ? (b->cpu_us - a->cpu_us) / dt / 1e4 : 0);
    printf(", \"client_cpu_percent\": %.1f", dt > 0 ? (b->self_us - a->self_us) / dt / 1e4 : 0);
    printf(", \"pings\": %" PRIu64 ", \"closes\": %" PRIu64 ", \"conn_errors\": %" PRIu64 ", \"other_frames\": %" PRIu64 ", \"masked_frames\": %" PRIu64, pings, closes, conn_errors, other_frames, masked_frames);
    if (first_error[0]) { printf(", "); json_str("first_error", first_error); }
    if (first_other[0]) { printf(", "); json_str("first_other_frame", first_other); }
    printf("}\n"); fflush(stdout);
}
static volatile sig_atomic_t stopping;
static void on_term(int s) { (void)s; stopping = 1; }                /* the report comes early, but it comes */
static void on_alarm(int s) { (void)s; static const char m[] = "wsload: watchdog: ran past its time\n"; if (write(2, m, sizeof m - 1)) { } _exit(2); }

static void usage(void) {
    fprintf(stderr,
        "usage: wsload --port N (--rate R | --window W | --idle N) [options]      (127.0.0.1 only)\n"
        "  --subs N (1) --pubs P (1) --size BYTES (32) --dur S (5) --warm S (1) --count MSGS (no limit)\n"
        "  --topic T (/wsload) --type X (std_msgs/String) --no-type --no-advertise --path / --header 'K: v'\n"
        "  --sub-extra '\"throttle_rate\":0' --pub-extra '\"latch\":false'   further JSON fields of subscribe / advertise\n"
        "  --msg '{\"data\":\"%%P\"}'     message with %%P for the payload\n"
        "  --window-at slowest|first|none  --drain S (10)  --setup S (60)  --inflight-connects K (16)\n"
        "  --hold S (3) --idle-nosub  (idle mode)\n"
        "  --pid PID (repeatable): CPU and RSS of the server   --label TEXT  --verbose\n");
    exit(1);
}

int main(int argc, char **argv) {
    enum { PORT = 256, SUBS, PUBS, SIZE, RATE, WINDOW, IDLE, DUR, WARM, COUNT, TOPIC, TYPE, NOTYPE, NOADV, PATH_, SUBX, PUBX, MSG, WAT, DRAIN, SETUP, INF, HOLD, PID, LABEL, VERB, NOSUB, HDR };
    static const struct option lo[] = {
        {"port", 1, 0, PORT}, {"subs", 1, 0, SUBS}, {"pubs", 1, 0, PUBS}, {"size", 1, 0, SIZE}, {"rate", 1, 0, RATE}, {"window", 1, 0, WINDOW},
        {"idle", 1, 0, IDLE}, {"dur", 1, 0, DUR}, {"warm", 1, 0, WARM}, {"count", 1, 0, COUNT}, {"topic", 1, 0, TOPIC}, {"type", 1, 0, TYPE},
        {"no-type", 0, 0, NOTYPE}, {"no-advertise", 0, 0, NOADV}, {"path", 1, 0, PATH_}, {"sub-extra", 1, 0, SUBX}, {"pub-extra", 1, 0, PUBX}, {"msg", 1, 0, MSG},
        {"window-at", 1, 0, WAT}, {"drain", 1, 0, DRAIN}, {"setup", 1, 0, SETUP}, {"inflight-connects", 1, 0, INF}, {"hold", 1, 0, HOLD},
        {"pid", 1, 0, PID}, {"label", 1, 0, LABEL}, {"verbose", 0, 0, VERB}, {"idle-nosub", 0, 0, NOSUB}, {"header", 1, 0, HDR}, {0, 0, 0, 0} };
    int k;
    while ((k = getopt_long(argc, argv, "", lo, NULL)) != -1) switch (k) {
        case PORT: o_port = atoi(optarg); break;   case SUBS: o_subs = atoi(optarg); break;   case PUBS: o_pubs = atoi(optarg); break;
        case SIZE: o_size = (unsigned)strtoul(optarg, 0, 10); break; case RATE: o_rate = atof(optarg); break; case WINDOW: o_window = atoi(optarg); break;
        case IDLE: o_idle = atoi(optarg); break;   case DUR: o_dur = atof(optarg); break;     case WARM: o_warm = atof(optarg); break;
        case COUNT: o_count = strtoull(optarg, 0, 10); break; case TOPIC: o_topic = optarg; break; case TYPE: o_type = optarg; break;
        case NOTYPE: o_no_type = true; break;      case NOADV: o_no_advertise = true; break;  case PATH_: o_path = optarg; break;
        case SUBX: o_sub_extra = optarg; break;    case PUBX: o_pub_extra = optarg; break;    case MSG: o_msg = optarg; break;
        case WAT: o_window_first = !strcmp(optarg, "first"); o_window_none = !strcmp(optarg, "none"); break; case DRAIN: o_drain = atof(optarg); break; case SETUP: o_setup = atof(optarg); break;
        case INF: o_inflight = atoi(optarg); break; case HOLD: o_hold = atof(optarg); break;  case LABEL: o_label = optarg; break;
        case PID: if (o_npids < MAX_PIDS) o_pids[o_npids++] = atoi(optarg); break; case VERB: o_verbose = true; break; case NOSUB: o_idle_nosub = true; break;
        case HDR: o_header = optarg; break;
        default: usage();
    }
    if (optind != argc || (o_idle >= 0) + (o_rate > 0) + (o_window > 0) != 1) usage();
    if (o_idle >= 0) { o_subs = o_idle; o_pubs = 0; }
    if (o_port < 1 || o_port > 65535 || o_subs < 0 || o_subs + o_pubs > LIMIT_CONNS || o_pubs > LIMIT_PUBS || o_window > LIMIT_WINDOW || o_size > LIMIT_SIZE
        || o_dur <= 0 || o_dur > LIMIT_DUR_S || o_warm < 0 || o_warm > 60 || o_hold < 0 || o_hold > LIMIT_DUR_S || o_drain < 0 || o_drain > 120
        || o_setup <= 0 || o_setup > 300 || o_inflight < 1 || o_rate > 1e6 || (o_idle < 0 && (o_subs < 1 || o_pubs < 1))) { fprintf(stderr, "wsload: an option is out of bounds\n"); return 1; }
    if (o_size < 24) o_size = 24;
    if (!o_count || o_count > LIMIT_MSGS) o_count = LIMIT_MSGS;
    signal(SIGPIPE, SIG_IGN); signal(SIGALRM, on_alarm); signal(SIGTERM, on_term);
    alarm((unsigned)(2 * o_setup + o_warm + o_dur + o_hold + o_drain + 30));
    struct rlimit rl; if (!getrlimit(RLIMIT_NOFILE, &rl)) { rl.rlim_cur = rl.rlim_max; setrlimit(RLIMIT_NOFILE, &rl); }
    rng ^= now_ns() * 2654435761u; if (!rng) rng = 1;

    /* the publish operation, with holes */
    const char *ph = strstr(o_msg, "%P"); if (!ph) { fprintf(stderr, "wsload: --msg wants a %%P\n"); return 1; }
    char *pay = xrealloc(NULL, o_size + 1); memset(pay, 'x', o_size); pay[o_size] = 0;
    memcpy(pay, "T=0000000000000000000;", 22); has_seq = o_size >= 32; if (has_seq) memcpy(pay + 22, "S=0000000;", 10);
    if (asprintf(&tmpl, "{\"op\":\"publish\",\"topic\":\"%s\",\"msg\":%.*s%s%s}", o_topic, (int)(ph - o_msg), o_msg, pay, ph + 2) < 0) die("out of memory");
    tmpl_len = strlen(tmpl); t_off = (size_t)(strstr(tmpl, "T=00000") - tmpl) + 2; s_off = t_off + 22;
    if (asprintf(&probe_tmpl, "{\"op\":\"publish\",\"topic\":\"%s\",\"msg\":%.*sW=00;%s}", o_topic, (int)(ph - o_msg), o_msg, ph + 2) < 0) die("out of memory");
    probe_len = strlen(probe_tmpl); probe_off = (size_t)(strstr(probe_tmpl, "W=00;") - probe_tmpl) + 2;

    ep = epoll_create1(EPOLL_CLOEXEC); ncon = o_subs + o_pubs;
    C = calloc((size_t)(ncon ? ncon : 1), sizeof *C); if (ep < 0 || !C) die("out of memory");
    for (int i = 0; i < ncon; i++) { C[i].idx = i; C[i].fd = -1; C[i].is_pub = i >= o_subs; }
    if (has_seq && o_pubs && 10000000 % o_pubs == 0)                /* message i comes from publisher i mod o_pubs */
        for (int i = 0; i < o_subs; i++) {
            C[i].next_seq = calloc((size_t)o_pubs, sizeof *C[i].next_seq); if (!C[i].next_seq) die("out of memory");
            for (int j = 0; j < o_pubs; j++) C[i].next_seq[j] = (uint64_t)j;
        }

    calib_ms[0] = calibrate();
    sample_t s0 = take_sample();
    double connect_s = open_all();

    if (o_idle >= 0) {
        uint64_t end = now_ns() + 500000000ULL; while (now_ns() < end) pump(20000000);          /* let the server settle */
        sample_t a = take_sample(); end = now_ns() + (uint64_t)(o_hold * 1e9);
        while (now_ns() < end) pump((int64_t)(end - now_ns()));
        sample_t b = take_sample();
        printf("{\"mode\": \"idle\", "); json_str("label", o_label);
        printf(", \"connections\": %d, \"open\": %d, \"server_rss_mb_before\": %.1f, \"server_rss_kb_per_conn\": %.1f, \"server_threads_before\": %ld, \"server_cpu_us_per_connect\": %.0f",
            ncon, n_open, s0.rss_mb, ncon ? (b.rss_mb - s0.rss_mb) * 1024 / ncon : 0, s0.threads, ncon ? (a.cpu_us - s0.cpu_us) / ncon : 0);
        print_tail(connect_s, &a, &b);
        return conn_errors ? 3 : 0;
    }

    /* probes, until every publisher reaches every subscriber */
    uint64_t t0 = now_ns(), end = t0 + (uint64_t)(o_setup * 1e9), next = t0; uint64_t all = o_pubs == 64 ? ~0ULL : (1ULL << o_pubs) - 1;
    for (int ready = 0; !ready; ) {
        uint64_t t = now_ns();
        if (t >= next) { next = t + 50000000; for (int j = 0; j < o_pubs; j++) send_probe(&C[o_subs + j], j); }
        pump(5000000);
        if (conn_errors) die("setup: %s", first_error);
        ready = 1; for (int i = 0; i < o_subs; i++) if (C[i].probes != all) { ready = 0; break; }
        if (!ready && now_ns() > end) { int m = 0; for (int i = 0; i < o_subs; i++) m += C[i].probes != all; die("setup: %d of %d subscribers do not receive from every publisher; other frame: %s", m, o_subs, first_other); }
    }
    double ready_s = (double)(now_ns() - t0) / 1e9;
    for (uint64_t q = now_ns(), lim = q + 5000000000ULL; now_ns() < lim && now_ns() - (last_probe_ns > q ? last_probe_ns : q) < 300000000ULL; ) pump(20000000);

    if (o_window) { uint32_t n = 1; while (n < (uint32_t)o_window * 2 + 2) n *= 2; ring = calloc(n, sizeof *ring); ring_mask = n - 1; if (!ring) die("out of memory"); }
    sample_t a, b; memset(&a, 0, sizeof a); memset(&b, 0, sizeof b);
    t0 = now_ns(); uint64_t tm0 = t0 + (uint64_t)(o_warm * 1e9), tm1 = tm0 + (uint64_t)(o_dur * 1e9), late_max = 0, i_msg = 0; int turn = 0;
    double gap = o_rate > 0 ? 1e9 / o_rate : 0;
    for (;;) {
        uint64_t t = now_ns();
        if (!measuring && t >= tm0) { measuring = record_lat = true; a = take_sample(); }
        if (stopping || t >= tm1 || conn_errors || total_sent >= o_count) break;
        int64_t wait = (int64_t)((measuring ? tm1 : tm0) - t);
        if (o_window) {
            int burst = 0;
            while ((o_window_none || total_sent - min_recv < (uint64_t)o_window) && total_sent < o_count && burst++ < 64) {
                conn_t *p = &C[o_subs + turn];
                if (p->txlen - p->txoff > (1u << 20)) break;
                send_publish(p); turn = (turn + 1) % o_pubs;
            }
            if (burst > 64) wait = 0;
        } else {
            uint64_t due = t0 + (uint64_t)((double)i_msg * gap);
            while (due <= t && total_sent < o_count) {
                if (measuring && t - due > late_max) late_max = t - due;
                send_publish(&C[o_subs + turn]); turn = (turn + 1) % o_pubs;
                i_msg++; due = t0 + (uint64_t)((double)i_msg * gap); t = now_ns();
            }
            if ((int64_t)(due - t) < wait) wait = (int64_t)(due - t);
        }
        pump(wait);
    }
    if (!measuring) { a = take_sample(); a.t = t0; a.recv = 0; a.sent = 0; }
    b = take_sample();
    uint64_t want = total_sent * (uint64_t)o_subs, lastp = now_ns();
    while (total_recv < want) {                                      /* what is still under way */
        uint64_t before = total_recv; pump(50000000);
        uint64_t t = now_ns(); if (total_recv != before) lastp = t; else if ((double)(t - lastp) / 1e9 > o_drain) break;
    }
    if (total_recv == want) for (uint64_t q = now_ns() + 100000000ULL; now_ns() < q; ) pump(20000000);   /* duplicates? */

    double dt = (double)(b.t - a.t) / 1e9; uint64_t del = b.recv - a.recv, pub = b.sent - a.sent, mn = UINT64_MAX, mx = 0, loss = 0, dups = 0;
    for (int i = 0; i < o_subs; i++) {
        uint64_t r = C[i].recv; if (r < mn) mn = r;
        if (r > mx) mx = r;
        if (r < total_sent) loss += total_sent - r; else dups += r - total_sent;
    }
    printf("{\"mode\": \"%s\", ", o_window ? "window" : "rate"); json_str("label", o_label);
    printf(", \"subs\": %d, \"pubs\": %d, \"size\": %u, \"%s\": %g, \"dur_s\": %.3f", o_subs, o_pubs, o_size, o_window ? "window" : "rate", o_window ? (double)o_window : o_rate, dt);
    printf(", \"deliveries\": %" PRIu64 ", \"deliveries_per_s\": %.1f, \"publishes\": %" PRIu64 ", \"publishes_per_s\": %.1f", del, (double)del / dt, pub, (double)pub / dt);
    printf(", \"total_published\": %" PRIu64 ", \"total_expected\": %" PRIu64 ", \"total_received\": %" PRIu64 ", \"loss\": %" PRIu64 ", \"dups\": %" PRIu64 ", \"sub_recv_min\": %" PRIu64 ", \"sub_recv_max\": %" PRIu64 ", \"out_of_order\": %" PRIu64,
        total_sent, want, total_recv, loss, dups, mn, mx, out_of_order);
    printf(", \"lat_us\": {\"n\": %" PRIu64 ", \"min\": %.1f, \"mean\": %.1f, \"p50\": %.1f, \"p90\": %.1f, \"p99\": %.1f, \"p999\": %.1f, \"max\": %.1f}, \"gen_late_us_max\": %.1f", hist_n, hist_n ? (double)hist_min / 1e3 : 0,
        hist_n ? hist_sum / (double)hist_n / 1e3 : 0, hist_pct(50), hist_pct(90), hist_pct(99), hist_pct(99.9), (double)hist_max / 1e3, (double)late_max / 1e3);
    printf(", \"cpu_us_per_delivery\": %.4f, \"cpu_us_per_publish\": %.2f, \"client_cpu_us_per_delivery\": %.2f", del ? (b.cpu_us - a.cpu_us) / (double)del : 0, pub ? (b.cpu_us - a.cpu_us) / (double)pub : 0, del ? (b.self_us - a.self_us) / (double)del : 0);
    printf(", \"rss_mb\": %.1f, \"rss_mb_start\": %.1f, \"rx_bytes\": %" PRIu64 ", \"tx_bytes\": %" PRIu64 ", \"rx_mb_per_s\": %.1f, \"ready_s\": %.3f, \"binary_frames\": %" PRIu64, b.rss_mb, a.rss_mb, rx_bytes, tx_bytes, (double)(b.rxb - a.rxb) / dt / 1e6, ready_s, binary_frames);
    print_tail(connect_s, &a, &b);
    return loss || dups || conn_errors ? 3 : 0;
}
