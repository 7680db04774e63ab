class QApplication:
    def __init__(self, words):
        pass
