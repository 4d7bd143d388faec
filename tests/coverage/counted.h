/* Included into every file of a build for gcov: processes that become others, or end without exit(), count what they
 * reached first. */
void __gcov_dump(void);
__attribute__((__noreturn__)) void _exit(int);
int __gcov_execv(const char *, char *const *);
int __gcov_execvp(const char *, char *const *);
static inline void counted_exit(int status) { __gcov_dump(); _exit(status); }
#define execv __gcov_execv
#define execvp __gcov_execvp
#define _exit counted_exit
