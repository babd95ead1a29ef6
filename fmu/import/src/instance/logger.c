/* The logger of FMI 2.0 has a variable list of arguments, which Rust cannot read: the text is put together here. */
#include <stdarg.h>
#include <stdio.h>

/* In two.rs. */
extern void toolroom_fmi2_message(void *environment, const char *message);

void toolroom_fmi2_logger(void *environment, const char *instance, int status, const char *category,
                          const char *message, ...) {
  char text[4096]; /* assumption: nobody reads on in a longer message */
  va_list arguments;
  (void)instance;
  (void)status;
  (void)category;
  if (message == NULL) return;
  va_start(arguments, message);
  int length = vsnprintf(text, sizeof text, message, arguments);
  va_end(arguments);
  /* A text that cannot be put together is shown as it came. */
  toolroom_fmi2_message(environment, length < 0 ? message : text);
}
